// Names as users write them.
#pragma once

// The name among `count` that is most like `name`, NULL when none is near.
const char *brunt_nearest_name(const char *name, const char *const *names, int count);
