"""The commands: the only room that knows names of options, exit codes and click."""
