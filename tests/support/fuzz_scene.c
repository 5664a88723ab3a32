// Fuzzing of the scene reader. With clang's libFuzzer: `sh tests/support/fuzz.sh SECONDS`. With -DSTANDALONE a mutating
// main of its own:
//     fuzz_scene SECONDS SEED FILE...
// A scene that is accepted must be written, read back and written again to the same text; nothing may stay allocated.
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "io/scene/scene.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static char *written(const brunt_scene *scene, size_t *length) {
    char *text = NULL;
    FILE *out = open_memstream(&text, length);
    if (!out || brunt_scene_write(scene, out) != BRUNT_OK) abort();
    fclose(out);
    return text;
}

static void round_trip(const brunt_scene *scene) {
    size_t first_length, second_length;
    char *first = written(scene, &first_length);
    brunt_scene again;
    if (brunt_scene_parse(first, first_length, "written", NULL, 0, &again, stderr) != BRUNT_OK) {
        fprintf(stderr, "the written scene is not accepted:\n%s\n", first);
        abort();
    }
    char *second = written(&again, &second_length);
    if (first_length != second_length || memcmp(first, second, first_length) != 0) {
        fprintf(stderr, "the scene changes when it is read back:\n%s\n---\n%s\n", first, second);
        abort();
    }
    free(first);
    free(second);
    brunt_scene_free(&again);
}

// What follows a line "#--set" is an override, so that those are fuzzed too.
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    static const char mark[] = "\n#--set ";
    const char *text = (const char *)data;
    size_t length = size;
    char option[256] = "";
    const char *found = size ? memmem(text, size, mark, sizeof mark - 1) : NULL;
    if (found) {
        length = (size_t)(found - text) + 1;
        size_t rest = size - length - (sizeof mark - 2);
        if (rest >= sizeof option) rest = sizeof option - 1;
        memcpy(option, found + sizeof mark - 1, rest);
    }
    const char *sets[] = {option};
    brunt_scene scene;
    char *messages = NULL;
    size_t message_length = 0;
    FILE *out = open_memstream(&messages, &message_length);
    int status = brunt_scene_parse(text, length, "fuzz.yaml", sets, *option ? 1 : 0, &scene, out);
    fclose(out);
    if (status == BRUNT_OK) {
        round_trip(&scene);
        brunt_scene_free(&scene);
    } else if (status != BRUNT_BAD_INPUT || message_length == 0) {
        abort();
    }
    free(messages);
    if (brunt_memory_live() != 0) abort();
    return 0;
}

#ifdef STANDALONE
#include <time.h>

enum { LARGEST = 1 << 16 };

static uint64_t state;

static uint64_t draw(uint64_t below) {
    state ^= state << 13;
    state ^= state >> 7;
    state ^= state << 17;
    return below ? state % below : 0;
}

static size_t mutate(uint8_t *data, size_t size) {
    static const char *const words[] = {
        "[",      "]",     "{",  "}",      ": ",     "- ",      "&a ",       "*a",        "\n",      "  ",    "\t",
        "#",      "'",     "\"", "|\n",    "1e400",  ".nan",    "-1",        "0",         "free",    "1 m/s", "mm",
        "deg",    "---\n", "? ", "!!int ", "<<: ",   "union: ", "\n#--set ", "time.end=", "bodies.", "\xff",  "%",
        "1e-320", "none",  "~",  "fem",    "mesh: ", "group: ", "fix: ",     "[[0, 0]",   "all"};
    for (uint64_t n = 1 + draw(6); n > 0; n--) {
        size_t at = draw(size + 1);
        switch (draw(5)) {
        case 0:
            if (size) data[draw(size)] = (uint8_t)draw(256);
            break;
        case 1: { // cut
            size_t length = draw(size - at < 40 ? size - at + 1 : 40);
            memmove(data + at, data + at + length, size - at - length);
            size -= length;
            break;
        }
        case 2: { // repeat a part elsewhere
            size_t length = draw(64), from = draw(size + 1);
            if (from + length > size || size + length > LARGEST) break;
            uint8_t part[64];
            memcpy(part, data + from, length);
            memmove(data + at + length, data + at, size - at);
            memcpy(data + at, part, length);
            size += length;
            break;
        }
        default: {
            const char *word = words[draw(sizeof words / sizeof *words)];
            size_t length = strlen(word);
            if (size + length > LARGEST) break;
            memmove(data + at + length, data + at, size - at);
            memcpy(data + at, word, length);
            size += length;
        }
        }
    }
    return size;
}

int main(int count, char **arguments) {
    if (count < 4) {
        fprintf(stderr, "fuzz_scene SECONDS SEED FILE...\n");
        return 64;
    }
    static uint8_t data[LARGEST + 64], seed[LARGEST];
    state = strtoull(arguments[2], NULL, 10) * 2654435769u + 88172645463325252u;
    time_t end = time(NULL) + atol(arguments[1]);
    long runs = 0;
    do {
        FILE *file = fopen(arguments[3 + draw((uint64_t)(count - 3))], "rb");
        if (!file) return 74;
        size_t size = fread(seed, 1, sizeof seed, file);
        fclose(file);
        for (int i = 0; i < 50; i++, runs++) {
            memcpy(data, seed, size);
            size_t mutated = mutate(data, size);
            // An allocation of its own, so that reading past the end is seen.
            uint8_t *exact = malloc(mutated ? mutated : 1);
            if (!exact) return 70;
            memcpy(exact, data, mutated);
            LLVMFuzzerTestOneInput(exact, mutated);
            free(exact);
        }
    } while (time(NULL) < end);
    printf("%ld runs\n", runs);
    return runs > 0 ? 0 : 1;
}
#endif
