// Files to be read: regular ones. A pipe would wait for ever for a writer, a device may never end.
#pragma once

#include <stdio.h>

// NULL, and why, when the file cannot be opened or is none. Does not wait.
FILE *brunt_input_open(const char *path, const char **why);
