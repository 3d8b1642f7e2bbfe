"""The commands, a module each: parse, one library call, one writer; `cli` loads the one it runs."""
