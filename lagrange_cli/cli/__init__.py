"""The commands: the only subpackage that knows names of options, exit codes and click.

A command imports the subpackages that it needs when it runs, because `lagtop` starts often.
"""
