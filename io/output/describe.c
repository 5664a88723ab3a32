#include "io/output/describe.h"

#include <errno.h>
#include <string.h>

#include "io/output/checkpoint.h"
#include "base/error.h"
#include "io/file/input_file.h"
#include "io/mesh/gmsh.h"
#include "io/file/hdf5_file.h"
#include "io/output/history.h"
#include "io/output/vtu.h"

int brunt_describe_file(const char *path, FILE *out, brunt_error *error) {
    char start[64] = "", kind[32];
    int format;
    const char *why;
    FILE *file = brunt_input_open(path, &why);
    if (!file) return brunt_fail(error, BRUNT_IO_ERROR, "%s: cannot open the file: %s", path, why);
    bool unreadable = fread(start, 1, sizeof start - 1, file) == 0 && ferror(file);
    if (unreadable) brunt_fail(error, BRUNT_IO_ERROR, "%s: cannot read the file: %s", path, strerror(errno));
    fclose(file);
    if (unreadable) return BRUNT_IO_ERROR;
    if (brunt_hdf5_kind(path, kind, &format))
        return strcmp(kind, "history") ? brunt_checkpoint_describe(path, out, error)
                                       : brunt_history_describe(path, out, error);
    if (!strncmp(start, "<?xml", 5) || !strncmp(start, "<VTKFile", 8)) return brunt_vtu_describe(path, out, error);
    const char *ending = strrchr(path, '.');
    if (!strncmp(start, "$MeshFormat", 11) || (ending && !strcmp(ending, ".msh")))
        return brunt_gmsh_describe(path, out, error);
    return brunt_fail(error, BRUNT_BAD_INPUT,
                      "%s: not a checkpoint, history, picture (.vtu) or collection (.pvd) of brunt, nor a mesh (.msh)",
                      path);
}
