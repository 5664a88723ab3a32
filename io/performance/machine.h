// What this machine was measured to do (bench/run.sh): for predictions and comparisons.
//
// A CSV file: lines "# key: value" that describe the machine, then
// "kind,name,units,threads,figure,unit,median,least,rounds".
#pragma once

#include <stdint.h>

#include "brunt.h"

typedef struct brunt_machine_row {
    char kind[32]; // roofline, particles, elements, materials, contact, growth, scene
    char name[96]; // "3d quadratic apic neo-hookean", "hex8", "slide 16", "two_disks"
    double units;  // particles, elements, nodes, bodies; 0: none
    int32_t threads;
    char figure[48]; // "step", a pass, "bandwidth", "bytes"
    char unit[32];   // "ns/particle", "GB/s", "GFLOP/s", "B/particle", "s"
    double median, least;
    int32_t rounds;
} brunt_machine_row;

typedef struct brunt_machine {
    char path[1024], processor[128]; // "": none was found
    brunt_machine_row *rows;
    int32_t row_count; // owned
    int32_t lanes;     // reals to a vector of the program that was measured; 0: it does not say
} brunt_machine;

// The stored benchmark of this machine: the file that the environment's BRUNT_MACHINE names, else NAME.csv of the
// folder the program was built with (bench/machines), NAME made of the processor's name and the number of cores; not
// one of a program with other vectors. BRUNT_OK also when there is none (row_count 0); BRUNT_BAD_INPUT for a file that
// is not one, with its line.
int brunt_machine_load(brunt_machine *machine, brunt_error *error);
void brunt_machine_free(brunt_machine *machine);
// The processor as the system names it, "unknown processor" where it does not.
void brunt_machine_processor(char out[128]);
// "amd-epyc-2", as the file is called.
void brunt_machine_name(char out[128]);
// The median of a figure, linear between the logarithms of the stored units, constant beyond them; NAN when nothing
// fits. `threads`: the nearest stored.
double brunt_machine_figure(const brunt_machine *machine, const char *kind, const char *name, const char *figure,
                            double units, int32_t threads);
// Seconds that a step of a world takes by the stored figures of its bodies' particles and elements: neo-Hookean
// material, no contact, no other effects. NAN when nothing is stored of one of them.
double brunt_machine_step(const brunt_machine *machine, const brunt_world_def *def, const brunt_world *world);
