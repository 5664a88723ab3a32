// Pictures that are kept in memory until they are written.
#include "io/output/vtu_picture.h"

#include "base/error.h"
#include "base/memory.h"

static void out_of_memory(const char *what, brunt_error *error) {
    brunt_fail(error, BRUNT_FAILED, "out of memory while writing a picture of %s", what);
}

brunt_vtu_picture *brunt_vtu_start(const brunt_world *world, const char *what, brunt_error *error) {
    brunt_vtu_picture *picture = brunt_alloc(sizeof *picture);
    if (picture)
        picture->time = brunt_world_time(world);
    else
        out_of_memory(what, error);
    return picture;
}

void *brunt_vtu_alloc(brunt_vtu_picture *picture, size_t bytes, const char *what, brunt_error *error) {
    BRUNT_ASSERT(picture->memory_count < PICTURE_BLOCKS);
    void *memory = brunt_alloc(bytes);
    if (memory)
        picture->memory[picture->memory_count++] = memory;
    else
        out_of_memory(what, error);
    return memory;
}

void brunt_vtu_add(brunt_vtu_picture *picture, brunt_vtu_array array) {
    BRUNT_ASSERT(picture->array_count < PICTURE_FIELDS);
    picture->arrays[picture->array_count++] = array;
}

int brunt_vtu_put(const char *path, const brunt_vtu_picture *picture, bool float32, brunt_error *error) {
    return brunt_vtu_write(path, picture->time, &picture->grid, picture->arrays, picture->array_count, float32, error);
}

void brunt_vtu_release(brunt_vtu_picture *picture) {
    for (int m = 0; picture && m < picture->memory_count; m++) brunt_free(picture->memory[m]);
    brunt_free(picture);
}
