"""The commands: the only subpackage that knows names of options, exit codes and click."""
