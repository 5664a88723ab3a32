// What the columns of a history mean: measures ask for them by name.
#pragma once

typedef struct history_column {
    const char *name;     // * stands for a name, ? for x, y and z
    const char *unit;     // SI; two where it is one or the other; NULL: that of the field
    const char *doc, *of; // of: what a scene must have for it; NULL: every scene has it
} history_column;

extern const history_column brunt_column_table[];
extern const int brunt_column_rows;

// The row of a column, by its whole name; NULL: there is none.
const history_column *brunt_column_meaning(const char *name);
