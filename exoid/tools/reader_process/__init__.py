"""Process that reads files whose libraries can crash or fill the memory, with bounds on memory and time."""
