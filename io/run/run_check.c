// What a run is asked before its first step: whether its fields and measures are there; and what warns of it.
#include "io/run/run.h"

#include <string.h>

#include "base/error.h"
#include "io/output/measures.h"

// Whether a name is among others, each of which has a space before it.
static bool is_listed(const char *names, const char *name) {
    const size_t length = strlen(name);
    for (const char *at = names; (at = strchr(at, ' ')); at++)
        if (strcspn(at + 1, " ") == length && !strncmp(at + 1, name, length)) return true;
    return false;
}

// The fields that any body has, each once.
static void list_fields(const brunt_world *world, char *names, size_t room) {
    size_t used = 0;
    for (int32_t b = 0; b < brunt_body_count(world); b++)
        for (int32_t f = 0; f < brunt_body_field_count(world, b); f++) {
            const char *name = brunt_body_field(world, b, f).name;
            int wrote = is_listed(names, name) ? 0 : snprintf(names + used, room - used, " %s", name);
            if ((size_t)wrote >= room - used) return;
            used += (size_t)wrote;
        }
}

void brunt_run_warn_from(const brunt_world *world, int32_t from, brunt_console *console) {
    for (int32_t w = from; w < brunt_warning_count(world); w++)
        brunt_console_print(console, "warning: %s\n", brunt_world_warning(world, w));
}

void brunt_run_warn(const brunt_scene *scene, const brunt_world *world, brunt_console *console) {
    for (const char *line = scene->warnings; line && *line;) {
        int length = (int)strcspn(line, "\n");
        brunt_console_print(console, "warning: %.*s\n", length, line);
        line += length + (line[length] == '\n');
    }
    brunt_run_warn_from(world, 0, console);
}

int brunt_run_check(const brunt_scene *scene, brunt_world *world, const brunt_history *history, FILE *messages,
                    brunt_error *error) {
    int mistakes = 0;
    brunt_error found = {0};
    for (int32_t f = 0; f < scene->output.field_count; f++) {
        bool known = strcmp(scene->output.fields[f], "default") == 0;
        for (int32_t b = 0; b < brunt_body_count(world); b++)
            known |= brunt_body_find_field(world, b, scene->output.fields[f]) >= 0;
        if (known) continue;
        char names[700] = "";
        list_fields(world, names, sizeof names);
        brunt_fail(mistakes ? &found : error, BRUNT_BAD_INPUT,
                   "output.fields[%d]: no body has a field '%s'; there are:%s", f, scene->output.fields[f], names);
        if (messages) brunt_scene_complain(scene, mistakes ? found.message : error->message, messages);
        mistakes++;
    }
    brunt_units *units = brunt_units_open();
    if (!units) return brunt_fail(error, BRUNT_FAILED, "out of memory");
    for (int32_t m = 0; m < scene->measure_count; m++) {
        if (!brunt_measure_check(&scene->measures[m], history, world, units, mistakes ? &found : error)) continue;
        if (messages) brunt_scene_complain(scene, mistakes ? found.message : error->message, messages);
        mistakes++;
    }
    brunt_units_close(units);
    if (scene->output.tractions && brunt_world_tell_tractions(world, mistakes ? &found : error)) {
        if (messages) brunt_scene_complain(scene, mistakes ? found.message : error->message, messages);
        mistakes++;
    }
    return mistakes ? BRUNT_BAD_INPUT : BRUNT_OK;
}
