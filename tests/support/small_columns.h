// Columns of the history of a run of the program.
#pragma once

#include "tests/support/small_program.h"

enum { ROWS = 64 };
// A column of history.csv of a folder; how many lines there are.
static inline int read_column(const char *folder, const char *name, double value[ROWS]) {
    char path[200], line[20000];
    snprintf(path, sizeof path, "%s/%s/history.csv", small_folder, folder);
    FILE *file = fopen(path, "r");
    ck_assert(file && fgets(line, sizeof line, file));
    int column = -1, count = 0, at = 0;
    for (char *head = strtok(line, ","); head; head = strtok(NULL, ","), at++)
        if (!strncmp(head, name, strlen(name)) && head[strlen(name)] == ' ') column = at;
    ck_assert_msg(column >= 0, "no column %s", name);
    for (; fgets(line, sizeof line, file) && count < ROWS; count++) {
        char *cell = line;
        for (int c = 0; c < column; c++) cell = strchr(cell, ',') + 1;
        value[count] = strtod(cell, NULL);
    }
    fclose(file);
    return count;
}
