// What the machine can do at most: bandwidth to memory and multiply-adds in registers, by number of threads.
//
//   bench_roofline [--quick] [-o FILE.csv]
//   bench_roofline --name        how the file of this machine is called
//
// 1, 2, 4, ... threads and as many as there are. -o: rows of a machine's file (bench/machines/README.md) are appended;
// in the column of the least stands the greatest, which says what the machine can do.
#include "io/performance/roofline.h"
#include "io/performance/machine.h"
#include "rows.h"

enum { ROUND_LIMIT = 8, COUNT_LIMIT = 16 };

int main(int argc, char **argv) {
    start_with_short_spins(argv);
    int rounds = 5, count = 0, threads[COUNT_LIMIT];
    const int most = brunt_threads_available();
    FILE *csv = NULL;
    for (int i = 1; i < argc; i++) {
        if (strcmp(argv[i], "--quick") == 0) {
            rounds = 1;
        } else if (strcmp(argv[i], "--name") == 0) {
            char name[128];
            brunt_machine_name(name);
            printf("%s\n", name);
            return BRUNT_OK;
        } else if (strcmp(argv[i], "-o") == 0 && i + 1 < argc && !csv) {
            csv = open_rows(argv[++i]);
            if (!csv) return BRUNT_IO_ERROR;
        } else {
            fprintf(stderr, "usage: bench_roofline [--quick] [-o FILE.csv] | --name\n");
            return BRUNT_BAD_USAGE;
        }
    }
    for (int t = 1; t < most && count < COUNT_LIMIT - 1; t *= 2) threads[count++] = t;
    threads[count++] = most;
    double bandwidth[COUNT_LIMIT][ROUND_LIMIT], flops[COUNT_LIMIT][ROUND_LIMIT];
    for (int r = 0; r < rounds; r++)
        for (int k = 0; k < count; k++)
            if (brunt_roofline_measure(threads[k], &bandwidth[k][r], &flops[k][r], NULL)) {
                fprintf(stderr, "bench_roofline: out of memory\n");
                return BRUNT_FAILED;
            }
    for (int k = 0; k < count; k++) {
        const row_key key = {"roofline", "machine", 0, threads[k]};
        const double gb = 1e-9 * median_of(bandwidth[k], rounds), gf = 1e-9 * median_of(flops[k], rounds);
        const double most_gb = 1e-9 * bandwidth[k][rounds - 1], most_gf = 1e-9 * flops[k][rounds - 1];
        printf("%2d thread%s %8.2f GB/s (%.2f)  %8.1f GFLOP/s (%.1f), median of the rounds (greatest in brackets)\n",
               threads[k], threads[k] == 1 ? " " : "s", gb, most_gb, gf, most_gf);
        write_row(csv, key, "bandwidth", "GB/s", gb, most_gb, rounds);
        write_row(csv, key, "flops", "GFLOP/s", gf, most_gf, rounds);
    }
    return close_rows(csv) ? BRUNT_OK : BRUNT_IO_ERROR;
}
