// Worlds that a wrong write has broken: whether that is noticed.
#pragma once

#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/support/def_world.h"
#include "world/world.h"

typedef void breaking(brunt_world *world);
static inline void break_nothing(brunt_world *w) { (void)w; }

// The signal that ends a process which looks the world over after `break_it`; 0: none.
static inline int signal_after(brunt_world *world, breaking *break_it) {
    const pid_t child = fork();
    ck_assert_int_ge(child, 0);
    if (!child) {
        break_it(world);
        brunt_world_validate(world);
        _exit(0);
    }
    int status = 0;
    ck_assert_int_eq(waitpid(child, &status, 0), child);
    return WIFSIGNALED(status) ? WTERMSIG(status) : 0;
}

// A world and what breaks it.
typedef struct broken_row {
    brunt_world *(*make)(void);
    breaking *break_it;
} broken_row;

static inline void check_noticed(const broken_row *row) {
    brunt_world *world = row->make();
    ck_assert_int_eq(signal_after(world, break_nothing), 0);
    world_steps(world, 3);
    ck_assert_int_eq(signal_after(world, break_nothing), 0);
    ck_assert_int_eq(signal_after(world, row->break_it), SIGABRT);
    brunt_world_destroy(world);
}

static inline brunt_body_def *def_mesh(brunt_world_def *def, const char *name, const double min[3],
                                       const double max[3]) {
    brunt_body_def *mesh = def_box(def, name, min, max);
    mesh->method = BRUNT_FEM, mesh->element = BRUNT_QUAD4, mesh->size = 0.1;
    return mesh;
}
