// history.h5: made of the lines, checked, described.
#include "io/output/history_lines.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/error.h"
#include "base/memory.h"
#include "io/file/atomic_file.h"
#include "io/file/hdf5_file.h"

enum { FORMAT = 2, BLOCK = 1 << 17, FEW_LINES = 64 }; // BLOCK: numbers at a time

// "body.rod.mass" -> "/body/rod/mass"
static void dataset_name(const char *column_name, char out[COLUMN_NAME + 1]) {
    snprintf(out, COLUMN_NAME + 1, "/%s", column_name);
    for (char *c = out; *c; c++)
        if (*c == '.') *c = '/';
}

static bool put_texts(const brunt_history *h, hid_t file) {
    return brunt_hdf5_put_text(file, "title", h->title) && brunt_hdf5_put_text(file, "version", BRUNT_VERSION) &&
           brunt_hdf5_put_integer(file, "run", (long long)h->run) &&
           brunt_hdf5_put_text(file, "force",
                               "mean over output.force_window, or since the line before where that is longer");
}

static hid_t make_column(const brunt_history *h, brunt_hdf5_maker *maker, int32_t c, const char *name, int64_t chunk) {
    hid_t set = brunt_hdf5_make(maker, name, H5T_IEEE_F64LE, (hsize_t)h->rows, (hsize_t)chunk);
    if (set < 0 || brunt_hdf5_put_text(set, "unit", h->columns[c].unit)) return set;
    H5Dclose(set);
    return H5I_INVALID_HID;
}

// Lines [first, first + count), which lie one after the other in `lines`, to their columns. The first of them make the
// columns, of which a chunk holds as many lines.
static bool put_lines(const brunt_history *h, brunt_hdf5_maker *maker, int64_t first, int64_t count,
                      const double *lines, double *values) {
    bool ok = true;
    for (int32_t c = 0; c < h->column_count && ok; c++) {
        char name[COLUMN_NAME + 1];
        dataset_name(h->columns[c].name, name);
        for (int64_t row = 0; row < count; row++) values[row] = lines[h->column_count * row + c];
        hid_t set =
            first ? H5Dopen2(maker->file, name, H5P_DEFAULT) : make_column(h, maker, c, name, count ? count : 1);
        ok = set >= 0 && (!count || brunt_hdf5_write_part(set, H5T_NATIVE_DOUBLE, first, count, values));
        if (set >= 0) H5Dclose(set);
    }
    return ok;
}

// Lines that are put at once: all, or no more than are to be in memory; of many columns some all the same, as all
// columns are opened for each block of lines.
static int64_t lines_at_once(const brunt_history *h) {
    const int64_t fitting = BLOCK / h->column_count, most = fitting > FEW_LINES ? fitting : FEW_LINES;
    return h->rows < 1 ? 1 : h->rows < most ? h->rows : most;
}

static int put_all(const brunt_history *h, hid_t file, const char *path, brunt_error *error) {
    const int64_t block = lines_at_once(h);
    double *lines = brunt_alloc(sizeof *lines * (size_t)(block * (h->column_count + 1)));
    line_reader r = {0};
    brunt_hdf5_maker maker;
    brunt_hdf5_maker_start(&maker, file);
    int status = lines ? brunt_history_open_lines(&r, h, brunt_history_lines_path(h), error)
                       : brunt_fail(error, BRUNT_FAILED, "out of memory while writing %s", path);
    bool ok = status || put_texts(h, file);
    for (int64_t first = 0; ok && !status && (first == 0 || first < h->rows); first += block) {
        const int64_t count = h->rows - first < block ? h->rows - first : block;
        for (int64_t row = 0; row < count && !status; row++)
            status = brunt_history_next_line(&r, NULL, lines + h->column_count * row, error);
        ok = status || put_lines(h, &maker, first, count, lines, lines + block * h->column_count);
    }
    if (!ok) status = brunt_fail(error, BRUNT_IO_ERROR, "%s: HDF5 could not write the file", path);
    brunt_history_close_lines(&r);
    brunt_hdf5_maker_end(&maker);
    brunt_free(lines);
    return status;
}

brunt_history *brunt_history_still(const brunt_history *history, brunt_error *error) {
    BRUNT_ASSERT(history->csv);
    brunt_history *still = brunt_alloc(sizeof *still);
    if (still)
        *still = *history;
    else
        brunt_fail(error, BRUNT_FAILED, "out of memory for history.h5");
    return still;
}

int brunt_history_write(const brunt_history *history, const char *path, brunt_error *error) {
    const double room = 65536 + (double)history->column_count * (4096 + 8.1 * (double)history->rows);
    brunt_atomic_file out;
    hid_t file;
    int status = brunt_hdf5_create_aside(path, (size_t)room, &out, &file, error);
    if (status) return status;
    status = put_all(history, file, path, error);
    status = brunt_hdf5_seal(file, "history", FORMAT, status, &out, error);
    return status ? status : brunt_atomic_rename(&out, error);
}

// Opens a column of a file; negative when there is none.
static hid_t open_column(hid_t file, const char *name, int64_t *count) {
    char path[COLUMN_NAME + 1];
    dataset_name(name, path);
    return brunt_hdf5_dataset(file, path, H5T_FLOAT, sizeof(double), count);
}

int brunt_history_check_file(const brunt_history *history, const char *path, brunt_error *error) {
    hid_t file;
    long long run = 0;
    int status = brunt_hdf5_open(path, "history", FORMAT, &file, error);
    if (status) return status;
    if (!brunt_hdf5_get_integer(file, "run", &run) || (uint64_t)run != history->run)
        status = brunt_fail(error, BRUNT_BAD_INPUT, "%s: the history of another run than this scene's", path);
    H5Fclose(file);
    return status;
}

typedef struct description {
    FILE *out;
    hid_t file;
} description;

static herr_t describe_dataset(hid_t root, const char *name, const H5O_info_t *info, void *context) {
    const description *d = context;
    (void)root;
    if (info->type != H5O_TYPE_DATASET) return 0;
    char unit[32] = "", column_name[COLUMN_NAME];
    double first = NAN, last = NAN;
    int64_t count;
    snprintf(column_name, sizeof column_name, "%s", name);
    for (char *c = column_name; *c; c++)
        if (*c == '/') *c = '.';
    hid_t set = open_column(d->file, column_name, &count);
    if (set >= 0) {
        brunt_hdf5_get_text(set, "unit", unit, sizeof unit);
        if (count > 0) brunt_hdf5_read(set, H5T_NATIVE_DOUBLE, 0, 1, &first);
        if (count > 0) brunt_hdf5_read(set, H5T_NATIVE_DOUBLE, count - 1, 1, &last);
        H5Dclose(set);
    }
    brunt_hdf5_printable(column_name);
    fprintf(d->out, "%-44s [%-8s] first %15.8g  last %15.8g\n", column_name, unit, first, last);
    return 0;
}

int brunt_history_describe(const char *path, FILE *out, brunt_error *error) {
    hid_t file;
    int status = brunt_hdf5_open(path, "history", FORMAT, &file, error);
    if (status) return status;
    char title[256] = "", version[64] = "";
    brunt_hdf5_get_text(file, "title", title, sizeof title);
    brunt_hdf5_get_text(file, "version", version, sizeof version);
    int64_t lines;
    hid_t time = open_column(file, "time", &lines);
    if (time >= 0) {
        H5Dclose(time);
        fprintf(out, "history of '%s', written by brunt %s: %lld lines\n", title, version, (long long)lines);
    } else {
        status = brunt_fail(error, BRUNT_BAD_INPUT, "%s: the history has no column 'time'", path);
    }
    description d = {out, file};
    if (!status && H5Ovisit2(file, H5_INDEX_NAME, H5_ITER_NATIVE, describe_dataset, &d, H5O_INFO_BASIC) < 0)
        status = brunt_fail(error, BRUNT_BAD_INPUT, "%s: HDF5 cannot read the file", path);
    H5Fclose(file);
    return status;
}
