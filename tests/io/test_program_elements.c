// Finite elements through the program: what a run writes of them, read back by VTK; a run in two legs; erosion of
// them and of material points; check and info.
#include "tests/support/small_scene.h"

#include <jansson.h>
#include <math.h>
#include <stdarg.h>
#include <sys/wait.h>
#include <unistd.h>

static void set_up(void) {
    small_folder_make();
    small_write(small_path("blocks.yaml"), small_elements_text, sizeof small_elements_text - 1);
}

// Runs a command in the test's folder ($P the program, $R the reader of pictures) and returns what it printed.
__attribute__((format(printf, 2, 3))) static const char *shell(int code, const char *format, ...) {
    static char output[1 << 16];
    char command[1024], line[1536];
    const char *program = getenv("BRUNT"), *source = getenv("BRUNT_SOURCE");
    ck_assert_msg(program && source, "BRUNT must name the program, BRUNT_SOURCE the source folder");
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(command, sizeof command, format, arguments);
    va_end(arguments);
    snprintf(line, sizeof line,
             "cd '%s' && P='%s' && R='/usr/bin/python3 %s/tests/support/read_vtu.py' && { %s; } 2>&1", small_folder,
             program, source, command);
    FILE *pipe = popen(line, "r");
    ck_assert_ptr_nonnull(pipe);
    output[fread(output, 1, sizeof output - 1, pipe)] = 0;
    int status = pclose(pipe);
    ck_assert_msg(WIFEXITED(status) && WEXITSTATUS(status) == code, "%s: %d\n%s", command, WEXITSTATUS(status), output);
    return output;
}

static void contains(const char *text, const char *part) {
    ck_assert_msg(strstr(text, part) != NULL, "'%s' is not in\n%s", part, text);
}

static json_t *summary_of(const char *folder) {
    char path[160];
    snprintf(path, sizeof path, "%s/%s/summary.json", small_folder, folder);
    json_t *object = json_load_file(path, 0, NULL);
    ck_assert_msg(object != NULL, "%s", path);
    return object;
}

static double number_of(const json_t *object, const char *key) {
    return json_number_value(json_object_get(object, key));
}

// Range of an array as the reader prints it.
static void range_of(const char *facts, const char *array, double range[2]) {
    const char *at = strstr(facts, array);
    ck_assert_msg(at != NULL, "'%s' is not in\n%s", array, facts);
    ck_assert_int_eq(sscanf(at + strlen(array), " %*d %lf %lf", &range[0], &range[1]), 2);
}

START_TEST(runs_and_pictures) {
    contains(shell(0, "$P run blocks.yaml -o out -t 1"), "element-steps/s");
    json_t *summary = summary_of("out");
    double elements = number_of(summary, "elements"), nodes = number_of(summary, "nodes");
    ck_assert_double_eq(number_of(summary, "particles"), 0);
    ck_assert(elements >= 32 + 5 * 8 && nodes >= 75 + 27);
    ck_assert(json_is_null(json_object_get(summary, "ns_per_particle_step")));
    ck_assert(json_is_null(json_object_get(summary, "particle_steps_per_s")));
    ck_assert_double_gt(number_of(summary, "ns_per_element_step"), 0);
    ck_assert_double_gt(number_of(summary, "element_steps_per_s"), 0);
    ck_assert(json_is_true(json_object_get(json_object_get(json_object_get(summary, "measures"), "kept"), "ok")));
    json_decref(summary);
    double range[2];
    const char *facts = shell(0, "$R --facts out/vtu/lower_000000.vtu");
    contains(facts, "points 75 cells 32 types 12\nvolume 0.032");
    range_of(facts, "point displacement", range);
    ck_assert(range[0] == 0 && range[1] == 0);
    range_of(facts, "cell id", range);
    ck_assert_double_eq(range[1], 31);
    facts = shell(0, "$R --facts out/vtu/upper_000001.vtu");
    contains(facts, " types 10\n");
    range_of(facts, "point velocity", range);
    ck_assert_double_lt(range[0], -2);
    range_of(facts, "point displacement", range);
    ck_assert(range[0] < -0.02 && range[0] > -0.05);
    range_of(facts, "point contact_state", range);
    ck_assert(range[0] == 0 && range[1] >= 1);
    range_of(facts, "cell stress", range);
    ck_assert_double_lt(range[0], 0);
    contains(shell(0, "$R --collection out/brunt.pvd"), "upper 0.04");
    contains(shell(0, "$P info out/vtu/upper_000001.vtu"), "at the elements\n");
    contains(shell(0, "$P info out/vtu/upper_000001.vtu"), "Float32 x 6 [Pa]\n");
    contains(shell(0, "$P info out/checkpoint.h5"), "elements   ");
    contains(shell(0, "head -1 out/history.csv"), "contact.lower-upper.area [m^2]");
}
END_TEST

START_TEST(two_legs_give_the_same_bits) {
    shell(0, "$P run blocks.yaml -o whole -t 1 -q");
    shell(0, "$P run blocks.yaml -o legs -t 2 -q --set time.end=0.02");
    shell(0, "$P run blocks.yaml -o legs -t 1 -q --resume");
    json_t *a = summary_of("whole"), *b = summary_of("legs");
    ck_assert_str_eq(json_string_value(json_object_get(a, "state_hash")),
                     json_string_value(json_object_get(b, "state_hash")));
    ck_assert_double_eq(number_of(a, "steps"), number_of(b, "steps"));
    json_decref(a);
    json_decref(b);
    shell(0, "cmp whole/history.csv legs/history.csv && cmp whole/vtu/upper_000004.vtu legs/vtu/upper_000004.vtu");
}
END_TEST

// A bar of elements and one of material points, both drawn out until a part of each fails.
static const char torn_text[] =
    "brunt: 1\n"
    "title: Two bars torn\n"
    "dimension: 2\n"
    "time: {end: 8 us}\n"
    "grid: {cell: 2 mm}\n"
    "materials: {copper: {preset: copper-ofhc, failure: {d1: 0.1, d2: 0, d3: 0, d4: 0, d5: 0}}}\n"
    "bodies:\n"
    "  bar: {method: fem, material: copper, size: 2 mm, shape: {box: {min: [0, 0], max: [40 mm, 8 mm]}},\n"
    "    wave: {velocity: [-500, 0], wave_vector: [78.54, 0], phase: 90 deg}}\n"
    "  points: {method: mpm, material: copper, shape: {box: {min: [0, 20 mm], max: [40 mm, 28 mm]}},\n"
    "    wave: {velocity: [-500, 0], wave_vector: [78.54, 0], phase: 90 deg}}\n"
    "  still: {method: mpm, material: copper, shape: {box: {min: [0, 40 mm], max: [4 mm, 44 mm]}}}\n"
    "output: {every: 2 us, history: 0.5 us, fields: [velocity, plastic_strain],\n"
    "  probes: {middle: {body: bar, point: [21 mm, 1 mm], field: pressure}}}\n"
    "measures: {gone: {history: body.bar.eroded_mass, unit: kg}, heat: {history: energy.heat}}\n";

static double measured(const json_t *summary, const char *name) {
    return number_of(json_object_get(json_object_get(summary, "measures"), name), "value");
}

START_TEST(erosion_is_reported) {
    small_write(small_path("torn.yaml"), torn_text, sizeof torn_text - 1);
    const char *text = shell(0, "$P run torn.yaml -o torn -t 1");
    contains(text, "eroded of bar: ");
    contains(text, " elements (failed ");
    contains(text, "eroded of points: ");
    contains(text, "of plastic, heat");
    ck_assert_ptr_null(strstr(text, "eroded of still"));
    json_t *summary = summary_of("torn"), *eroded = json_object_get(summary, "eroded"),
           *bar = json_object_get(eroded, "bar"), *points = json_object_get(eroded, "points"),
           *energy = json_object_get(summary, "energy");
    ck_assert_int_eq((int)json_object_size(eroded), 2); // of `still` nothing
    ck_assert(number_of(bar, "elements") > 0 && number_of(bar, "particles") == 0 && number_of(points, "particles") > 0);
    ck_assert_double_eq(number_of(bar, "failed"), number_of(bar, "elements"));
    ck_assert(number_of(bar, "strained") == 0 && number_of(bar, "short_step") == 0 && number_of(bar, "inverted") == 0);
    ck_assert_int_eq((int)json_array_size(json_object_get(bar, "momentum")), 3);
    // Material points leave with all of their mass, 4 to a cell of 2 mm.
    const double point = 8930 * 1e-6;
    ck_assert_double_eq_tol(number_of(points, "mass"), number_of(points, "particles") * point, 1e-4 * point);
    ck_assert_double_eq(measured(summary, "gone"), number_of(bar, "mass"));
    ck_assert_double_eq_tol(number_of(energy, "eroded"), number_of(bar, "energy") + number_of(points, "energy"),
                            1e-9 * number_of(energy, "initial"));
    // Nine tenths of the plastic work become heat, of what is still there and of what has been eroded.
    ck_assert_double_eq(measured(summary, "heat"), number_of(energy, "heat"));
    ck_assert_double_eq_tol(number_of(energy, "heat"), 0.9 * number_of(energy, "plastic"),
                            1e-3 * number_of(energy, "plastic"));
    ck_assert_double_gt(number_of(energy, "heat"), 0);
    json_decref(summary);
    contains(shell(0, "head -1 torn/history.csv"), "body.points.eroded [1],body.points.eroded_mass [kg]");
    contains(shell(0, "tail -1 torn/history.csv"), "nan"); // the probe's element is eroded
    // Pictures keep the numbers that elements and points had.
    double range[2];
    range_of(shell(0, "$R --facts torn/vtu/bar_000004.vtu"), "cell id", range);
    ck_assert(range[0] == 0 && range[1] == 79);
    range_of(shell(0, "$R --facts torn/vtu/points_000004.vtu"), "point id", range);
    ck_assert(range[0] == 0 && range[1] == 4 * 80 - 1);
}
END_TEST

START_TEST(erosion_in_two_legs_gives_the_same_bits) {
    small_write(small_path("torn.yaml"), torn_text, sizeof torn_text - 1);
    shell(0, "$P run torn.yaml -o whole -t 1 -q");
    shell(0, "$P run torn.yaml -o legs -t 2 -q --set time.end=4us");
    json_t *half = summary_of("legs");
    const double before = number_of(json_object_get(json_object_get(half, "eroded"), "bar"), "elements");
    json_decref(half);
    shell(0, "$P run torn.yaml -o legs -t 1 -q --resume");
    json_t *a = summary_of("whole"), *b = summary_of("legs");
    ck_assert_str_eq(json_string_value(json_object_get(a, "state_hash")),
                     json_string_value(json_object_get(b, "state_hash")));
    ck_assert(json_equal(json_object_get(a, "eroded"), json_object_get(b, "eroded")));
    ck_assert(json_equal(json_object_get(a, "energy"), json_object_get(b, "energy")));
    const double after = number_of(json_object_get(json_object_get(b, "eroded"), "bar"), "elements");
    ck_assert(before > 0 && after > before); // in both legs
    json_decref(a);
    json_decref(b);
    shell(0, "cmp whole/history.csv legs/history.csv && diff -r whole/vtu legs/vtu");
    // The scene as it was resolved is the same run.
    shell(0, "$P run whole/scene.yaml -o again -t 1 -q && cmp whole/history.csv again/history.csv");
}
END_TEST

START_TEST(check_and_warnings) {
    const char *text = shell(0, "$P check blocks.yaml -t 1");
    contains(text, "32 hex8 elements, 75 nodes");
    contains(text, "tet4 elements");
    contains(text, "worst shape 1 of 1");
    contains(text, "least stable step");
    contains(text, "the step is that of body ");
    contains(text, " times as long without the body (steps ");
    contains(text, "ns per element-step");
    ck_assert_ptr_null(strstr(text, "warning:"));
    static const char said[] = "warning: grid: no body is of method mpm, it is not used\n";
    contains(shell(0, "$P check blocks.yaml -t 1 --set 'grid={cell: 0.1}'"), said);
    contains(shell(0, "$P run blocks.yaml -o out -t 1 --set 'grid={cell: 0.1}' --set time.end=1e-4"), said);
    contains(shell(0, "cat out/log.txt"), said);
    contains(shell(65, "$P run blocks.yaml -o out -t 1 --set boundaries[1].group=xmim"), "xmin");
}
END_TEST

// A box of gmsh's, of two bricks: the scene may lie anywhere, and the run may be moved.
START_TEST(mesh_files) {
    static const char mesh[] =
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n2\n3 1 \"core\"\n2 2 \"left face\"\n"
        "$EndPhysicalNames\n$Nodes\n12\n1 0 0 0\n2 1 0 0\n3 2 0 0\n4 0 1 0\n5 1 1 0\n6 2 1 0\n7 0 0 1\n"
        "8 1 0 1\n9 2 0 1\n10 0 1 1\n11 1 1 1\n12 2 1 1\n$EndNodes\n$Elements\n3\n"
        "1 5 2 1 1 1 2 5 4 7 8 11 10\n2 5 2 1 1 2 3 6 5 8 9 12 11\n3 3 2 2 2 1 4 10 7\n$EndElements\n";
    static const char scene[] =
        "brunt: 1\ndimension: 3\ntime: {end: 0.02}\n"
        "materials: {m: {model: neo-hookean, density: 1000, E: 1e6, nu: 0.3}}\n"
        "bodies: {b: {method: fem, material: m, mesh: two.msh}}\n"
        "boundaries:\n  - {group: left face, body: b, fix: all}\n"
        "loads: {gravity: [0, 0, -10]}\noutput: {every: 10 ms, checkpoint: 0 s, fields: [default, J]}\n";
    shell(0, "mkdir case");
    small_write(small_path("case/two.msh"), mesh, sizeof mesh - 1);
    small_write(small_path("case/sag.yaml"), scene, sizeof scene - 1);
    shell(0, "$P run case/sag.yaml -o case/out -q -t 1");
    contains(shell(0, "$R --facts case/out/vtu/b_000000.vtu"), "points 12 cells 2 types 12\nvolume 2\n");
    double range[2];
    range_of(shell(0, "$R --facts case/out/vtu/b_000002.vtu"), "point displacement", range);
    ck_assert_double_eq_tol(range[0], -0.5 * 10 * 0.02 * 0.02, 4e-4);
    shell(0, "mv case moved && $P run moved/sag.yaml -o moved/out --resume -q -t 1 --set time.end=0.03");
    contains(shell(0, "$P info moved/two.msh"), "core");
    contains(
        shell(65,
              "sed -i 's/^12 2 1 1/12 2.1 1 1/' moved/two.msh && $P run moved/sag.yaml -o moved/out --resume -q -t 1"),
        "a mesh file has changed");
}
END_TEST

// Meshes of boundaries and of the grid are of a run as those of bodies are.
START_TEST(mesh_files_of_boundaries_and_grid) {
    static const char
        plane[] = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n2 1 \"slope\"\n$EndPhysicalNames\n"
                  "$Nodes\n3\n1 -3 -3 0\n2 3 -3 0\n3 0 3 0\n$EndNodes\n$Elements\n1\n1 2 2 1 1 1 2 3\n"
                  "$EndElements\n",
        falls[] = "brunt: 1\ndimension: 3\ntime: {end: 0.004}\ngrid: {cell: 0.1}\n"
                  "materials: {m: {model: neo-hookean, density: 1000, E: 1e6, nu: 0.3}}\n"
                  "bodies: {b: {method: mpm, material: m, shape: {box: {min: [0, 0, 0], max: [0.2, 0.2, 0.2]}}}}\n"
                  "boundaries:\n  - {name: floor, mesh: {file: plane.msh, group: slope}, condition: separate}\n"
                  "loads: {gravity: [0, 0, -10]}\noutput: {every: none, checkpoint: 0 s}\n",
        cells[] = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n4\n1 -1 -1 0\n2 3 -1 0\n3 3 3 0\n4 -1 3 0\n"
                  "$EndNodes\n$Elements\n2\n1 2 2 1 1 1 2 3\n2 2 2 1 1 1 3 4\n$EndElements\n",
        moves[] = "brunt: 1\ndimension: 2\ntime: {scheme: implicit, step: 0.001, end: 0.004}\n"
                  "grid: {cell: 0.1, kernel: linear, transfer: flip, cells: {mesh: cells.msh}}\n"
                  "materials: {m: {model: neo-hookean, density: 1000, E: 1e6, nu: 0.3}}\n"
                  "bodies: {b: {method: mpm, material: m, shape: {box: {min: [0, 0], max: [0.2, 0.2]}}}}\n"
                  "loads: {gravity: [0, -10]}\noutput: {every: none, checkpoint: 0 s}\n";
    small_write(small_path("plane.msh"), plane, sizeof plane - 1);
    small_write(small_path("falls.yaml"), falls, sizeof falls - 1);
    small_write(small_path("cells.msh"), cells, sizeof cells - 1);
    small_write(small_path("moves.yaml"), moves, sizeof moves - 1);
    shell(0, "$P run falls.yaml -o f -q -t 1 && $P run falls.yaml -o f --resume -q -t 1 --set time.end=0.006");
    shell(0, "$P run moves.yaml -o m -q -t 1 && $P run moves.yaml -o m --resume -q -t 1 --set time.end=0.006");
    // The same cells in a file of millimetres.
    shell(0, "sed 's/^\\([1-4]\\) \\(-*[13]\\) \\(-*[13]\\) 0$/\\1 \\2000 \\3000 0/' cells.msh > mm.msh && grep -q '^3 "
             "3000 3000 0' mm.msh");
    shell(0, "sed 's/cells.msh/mm.msh, unit: 1 mm/' moves.yaml > mm.yaml && $P run mm.yaml -o mm -q -t 1 && "
             "$P run moves.yaml -o m2 -q -t 1 && diff mm/history.csv m2/history.csv");
    shell(0, "sed -i 's/^3 0 3 0/3 0.001 3 0/' plane.msh && sed -i 's/^3 3 3 0/3 3.5 3.5 0/' cells.msh");
    contains(shell(65, "$P run falls.yaml -o f --resume -q -t 1 --set time.end=0.008"), "a mesh file has changed");
    contains(shell(65, "$P run moves.yaml -o m --resume -q -t 1 --set time.end=0.008"), "a mesh file has changed");
}
END_TEST

// What a result may be taken for is said at its end: a beam of one element across bends by hourglass modes and was made
// heavier; barriers of a tenth of a block's height keep half of the way to themselves. With little of it nothing is
// said.
START_TEST(doubtful_energies_are_told) {
    static const char
        beam[] =
            "brunt: 1\ndimension: 3\ntime: {end: 0.05}\n"
            "materials: {m: {model: linear-elastic, density: 1000, E: 1e6, nu: 0.3}}\n"
            "bodies: {b: {method: fem, material: m, element: hex8, size: 0.1, mass_scaling: 5 ms,\n"
            "    hourglass: {coefficient: 0.5}, shape: {box: {min: [0, 0, 0], max: [0.5, 0.1, 0.1]}}}}\n"
            "boundaries:\n  - {body: b, group: xmin, fix: all}\n  - {body: b, group: xmax, traction: [0, 1e3, 0]}\n"
            "output: {every: none}\n",
        press[] =
            "brunt: 1\ndimension: 3\ntime: {scheme: static, steps: 2}\n"
            "materials: {m: {model: neo-hookean, density: 1000, E: 1e6, nu: 0.3}}\n"
            "bodies: {b: {method: fem, material: m, element: hex8, size: 0.01,\n"
            "    shape: {box: {min: [0, 0, 0.001], max: [0.01, 0.01, 0.011]}}}}\n"
            "boundaries:\n  - {plane: {point: [0, 0, 0], normal: [0, 0, 1]}, condition: separate}\n"
            "  - {plane: {point: [0, 0, 0.012], normal: [0, 0, -1]}, condition: separate, velocity: [0, 0, -0.003]}\n"
            "contact: {distance: 0.001}\noutput: {every: none}\n";
    small_write(small_path("beam.yaml"), beam, sizeof beam - 1);
    small_write(small_path("press.yaml"), press, sizeof press - 1);
    const char *told = shell(0, "$P run beam.yaml -o beam -t 1");
    contains(told, "note: hourglass modes have"), contains(told, "mass scaling of b: 5 elements made denser");
    json_t *summary = summary_of("beam");
    const double added = number_of(json_object_get(summary, "added_mass"), "b"), own = 1000 * 0.5 * 0.01;
    ck_assert_double_gt(added, own);
    json_decref(summary);
    told = shell(0, "$P run beam.yaml -o stiff -t 1 --set materials.m.E=1e9 --set materials.m.density=1e6 --set "
                    "'boundaries[1].traction=[0, 1e6, 0]'"); // shares do not go by how much energy there is
    contains(told, "note: hourglass modes have");
    const char *bulk = "$P run beam.yaml -o bulk -t 1 --set 'bodies.b.size=0.05' --set 'bodies.b.hourglass={}' --set "
                       "bodies.b.mass_scaling='1 us' --set 'boundaries[1].traction=[1000, 0, 0]'";
    told = shell(0, bulk);
    ck_assert_msg(!strstr(told, "note:") && !strstr(told, "mass scaling of"), "%s", told);
    contains(shell(0, "$P run press.yaml -o press -t 1"), "note: what pushes surfaces apart has stored");
    told =
        shell(0, "$P run press.yaml -o near -t 1 --set contact.distance=1e-4 --set 'bodies.b.place=[{translate: [0, 0, "
                 "-0.0009]}]' --set 'boundaries[1].plane.point=[0, 0, 0.0102]'");
    ck_assert_msg(!strstr(told, "note:"), "%s", told);
}
END_TEST

// Nodes that fly to and fro in turns: 1 m/s against each other, so that after 0.05 s the half of elements of 0.1 m is
// used up. Told once, of what elements with one point do alone, and not before.
START_TEST(folded_elements_are_told) {
    static const char scene[] =
        "brunt: 1\ndimension: 2\ntime: {end: 0.06}\n"
        "materials: {m: {model: neo-hookean, density: 1000, E: 1e6, nu: 0.3}}\n"
        "bodies: {a: {method: fem, material: m, element: quad4, size: 0.1, shape: {box: {min: [0, 0], max: [0.4, "
        "0.4]}}, "
        "hourglass: {coefficient: 0}, "
        "wave: {velocity: [1, 0], wave_vector: [31.41592653589793, 31.41592653589793], phase: 90 deg}}}\n"
        "output: {every: none}\n";
    small_write(small_path("folds.yaml"), scene, sizeof scene - 1);
    contains(shell(0, "$P run folds.yaml -o f -t 1"),
             "warning: bodies.a: at t = 0.06 s 16 of 16 elements are turned inside out at a corner");
    shell(0, "$P run folds.yaml -o g -t 1 --set time.end=2 --set time.energy_limit=1000 | grep -c 'inside out' | grep "
             "-qx 1");
    shell(1, "$P run folds.yaml -o h -t 1 --set time.end=0.04 | grep 'inside out'");
    shell(1, "$P run folds.yaml -o i -t 1 --set bodies.a.hourglass.coefficient=0.05 | grep 'inside out'");
}
END_TEST

int main(void) {
    Suite *suite = suite_create("program_elements");
    TCase *runs = tcase_create("runs");
    tcase_set_timeout(runs, 0);
    tcase_add_checked_fixture(runs, set_up, small_folder_remove);
    tcase_add_test(runs, runs_and_pictures);
    tcase_add_test(runs, two_legs_give_the_same_bits);
    tcase_add_test(runs, erosion_is_reported);
    tcase_add_test(runs, erosion_in_two_legs_gives_the_same_bits);
    tcase_add_test(runs, check_and_warnings);
    tcase_add_test(runs, mesh_files);
    tcase_add_test(runs, mesh_files_of_boundaries_and_grid);
    tcase_add_test(runs, doubtful_energies_are_told);
    tcase_add_test(runs, folded_elements_are_told);
    suite_add_tcase(suite, runs);
    return suite_main(suite);
}
