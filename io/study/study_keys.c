// Every key of a study file, one row each.
#include "io/scene/scene_rows.h"
#include "brunt/error.h"

// clang-format off
static const scene_key rows[] = {
    {"brunt_study", SCENE_INTEGER, NULL, REQUIRED, 1, 1, false, false, NULL, 0, false, "version of the study format: 1"},
    {"title", SCENE_TEXT, NULL, "''", NONE, "one line on what is studied"},
    {"scene", SCENE_TEXT, NULL, OPTIONAL, NONE, "the scene file; its path counts from the study's folder. May be left out where the values of an axis give one each"},
    {"set", SCENE_ANY, NULL, OPTIONAL, NONE, "a map from paths of the scene to values, for every run"},
    {"threads", SCENE_INTEGER, NULL, "1", 1, BRUNT_THREAD_LIMIT, false, false, NULL, 0, false, "of each run; runs are taken one at a time"},
    {"repeats", SCENE_INTEGER, NULL, "3", 1, 1000, false, false, NULL, 0, false, "runs of each case: the median of their times counts; their results must be the same bits"},
    {"time_limit", SCENE_REAL, "s", "1 h", 0, INFINITY, true, true, "none", 0, false, "of the clock for one run: past it the case counts as failed"},

    {"axes", SCENE_NAMED, NULL, REQUIRED, NONE, "what is varied; every combination of their values is a case"},
    {"axes.*.key", SCENE_TEXT, NULL, OPTIONAL, NONE, "the path of the scene that takes the value, or one of the words scene, threads, program (of another build, for comparison)"},
    {"axes.*.keys", SCENE_ANY, NULL, OPTIONAL, NONE, "a list of paths that all take the value; without key and keys it is only put in where text holds {NAME}"},
    {"axes.*.values", SCENE_ANY, NULL, OPTIONAL, NONE, "a list of values, or a map from labels to values; a value of an axis without key and keys may be a map from paths to what they take, also of scene, threads and program"},
    {"axes.*.scale", SCENE_REALS, "1", OPTIONAL, POSITIVE, NULL, 0, false, "in place of values: factors on what the scene itself has at the keys"},
    {"axes.*.role", SCENE_WORD, NULL, "method", ANY, "method|resolution", 0, false, "each combination of methods is a line of the plots, with a point a resolution; the numbers of a resolution fall as it becomes finer. One axis at most is of it"},

    {"measures", SCENE_NAMED, NULL, REQUIRED, NONE, "what is judged: the scene's measures by their names"},
    {"measures.*.reference", SCENE_ANY, NULL, OPTIONAL, NONE, "what is right: scene (what the scene expects; default), a number, finest (the finest run), richardson (the limit of each method's own runs), or {axis: NAME, values: {LABEL: NUMBER}}"},
    {"measures.*.of", SCENE_TEXT, NULL, OPTIONAL, NONE, "with finest and richardson: the one method whose runs are the reference of all, by its line (`APIC, quadratic`) or a label of it (`APIC`)"},
    {"measures.*.title", SCENE_TEXT, NULL, "''", NONE, "of the axis of errors (default: error of NAME)"},
    {"measures.*.scale", SCENE_ANY_UNIT, "any", OPTIONAL, POSITIVE, NULL, 0, false, "errors are in parts of it (default: of the reference)"},
    {"measures.*.order", SCENE_REAL, "1", OPTIONAL, POSITIVE, NULL, 0, false, "of convergence, as theory has it: drawn beside the lines"},

    {"accuracies", SCENE_REALS, "1", OPTIONAL, POSITIVE, NULL, 0, false, "errors for which the report says what each method costs (default [10 %, 3 %, 1 %])"},
    {"skip", SCENE_ANY, NULL, OPTIONAL, NONE, "a list of maps from axes to labels: cases that have all of the labels of one are left out"},
};
static const int row_count = sizeof rows / sizeof *rows;
// clang-format on

const scene_format brunt_study_format = {"study", "brunt_study: 1", rows, &row_count};
