#include "base/names.h"

#include <stdlib.h>
#include <string.h>

#include "base/array.h"

static int compare(const void *a, const void *b) {
    const brunt_name_entry *p = a, *q = b;
    const int order = strcmp(p->name, q->name);
    return order ? order : (p->index > q->index) - (p->index < q->index);
}

int brunt_names_sort(brunt_names *names, const char *first, size_t stride, int32_t count, brunt_error *error) {
    *names = (brunt_names){.count = 0};
    if (BRUNT_NEW(names->entry, count + 1, "names in their order", error)) return BRUNT_FAILED;
    names->count = count;
    for (int32_t i = 0; i < count; i++) names->entry[i] = (brunt_name_entry){first + stride * (size_t)i, i};
    qsort(names->entry, (size_t)count, sizeof *names->entry, compare);
    return BRUNT_OK;
}

int32_t brunt_names_find(const brunt_names *names, const char *name, size_t length) {
    int32_t low = 0, high = names->count;
    while (low < high) {
        const int32_t middle = low + (high - low) / 2;
        if (strncmp(names->entry[middle].name, name, length) < 0)
            low = middle + 1;
        else
            high = middle;
    }
    // Of names that begin alike the one that ends there stands first.
    if (low == names->count || strncmp(names->entry[low].name, name, length) || names->entry[low].name[length])
        return BRUNT_NONE;
    return names->entry[low].index;
}

void brunt_names_free(brunt_names *names) {
    brunt_free(names->entry);
    *names = (brunt_names){.count = 0};
}
