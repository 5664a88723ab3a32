#include "base/array.h"

#include "base/memory.h"

#include <stdint.h>
#include <string.h>

void *brunt_array_fit(void *memory, size_t *capacity, size_t size, size_t count, size_t keep) {
    if (brunt_array_holds(memory, *capacity, size, count) || count > SIZE_MAX / 2 / size) return memory;
    const size_t bytes = count * size, grown = bytes + bytes / 2;
    void *larger = brunt_alloc(grown);
    if (!larger) return memory;
    if (keep) memcpy(larger, memory, keep * size);
    brunt_free(memory);
    *capacity = grown;
    return larger;
}
