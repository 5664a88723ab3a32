// gnuplot: pictures made of the scripts that study_plot.c writes.
#pragma once

#include <stdbool.h>

#include "brunt.h"

// Runs NAME.gp in the folder. `*there` is false when there is no gnuplot. BRUNT_IO_ERROR: what it said.
int gnuplot_run(const char *folder, const char *name, bool *there, brunt_error *error);
// Removes NAME.svg and NAME.png, or the file of one ending; none there is no mistake.
int gnuplot_remove_pictures(const char *folder, const char *name, brunt_error *error);
int gnuplot_remove_file(const char *folder, const char *name, const char *ending, brunt_error *error);
