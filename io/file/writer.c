#include "io/file/writer.h"

#include <pthread.h>
#include <signal.h>

#include "base/error.h"
#include "base/memory.h"
#include "base/parallel.h"

enum { IN_LINE = 32 }; // jobs; of one picture with more parts the rest is taken as these are written

struct brunt_writer {
    bool beside; // there is a thread
    pthread_t thread;
    pthread_mutex_t lock; // of all that follows
    pthread_cond_t changed;
    brunt_job line[IN_LINE]; // from `first` on, the first of which is being written
    int first, count;
    bool ending;
    brunt_error failure; // of code BRUNT_OK: none
};

// Those behind one that has failed are dropped.
static void do_job(brunt_writer *w, brunt_job job) {
    brunt_error error = {.id = -1};
    int status = BRUNT_OK;
    if (!w->failure.code) status = job.write(job.job, &error);
    job.release(job.job);
    if (!status) return;
    error.code = status;
    if (w->beside) pthread_mutex_lock(&w->lock);
    w->failure = error;
    if (w->beside) pthread_mutex_unlock(&w->lock);
}

static void *work(void *context) {
    brunt_writer *w = context;
    pthread_mutex_lock(&w->lock);
    for (;;) {
        while (!w->count && !w->ending) pthread_cond_wait(&w->changed, &w->lock);
        if (!w->count) break;
        const brunt_job job = w->line[w->first];
        pthread_mutex_unlock(&w->lock);
        brunt_parallel_beside(true);
        do_job(w, job);
        brunt_parallel_beside(false);
        pthread_mutex_lock(&w->lock);
        w->first = (w->first + 1) % IN_LINE, w->count--;
        pthread_cond_broadcast(&w->changed);
    }
    pthread_mutex_unlock(&w->lock);
    return NULL;
}

// Signals are for the run.
static bool start_thread(brunt_writer *w) {
    sigset_t all, before;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before);
    const bool made = pthread_create(&w->thread, NULL, work, w) == 0;
    pthread_sigmask(SIG_SETMASK, &before, NULL);
    return made;
}

brunt_writer *brunt_writer_start(bool beside, brunt_error *error) {
    brunt_writer *w = brunt_alloc(sizeof *w);
    if (!w) {
        brunt_fail(error, BRUNT_FAILED, "out of memory");
        return NULL;
    }
    pthread_mutex_init(&w->lock, NULL);
    pthread_cond_init(&w->changed, NULL);
    pthread_mutex_lock(&w->lock); // it looks at `beside`
    w->beside = beside && start_thread(w);
    pthread_mutex_unlock(&w->lock);
    return w;
}

void brunt_writer_end(brunt_writer *w) {
    if (!w) return;
    if (w->beside) {
        pthread_mutex_lock(&w->lock);
        w->ending = true;
        pthread_cond_broadcast(&w->changed);
        pthread_mutex_unlock(&w->lock);
        pthread_join(w->thread, NULL);
    }
    pthread_cond_destroy(&w->changed);
    pthread_mutex_destroy(&w->lock);
    brunt_free(w);
}

int brunt_writer_give(brunt_writer *w, brunt_job job, brunt_error *error) {
    if (!w->beside) {
        do_job(w, job);
        return brunt_hand_on(error, &w->failure);
    }
    pthread_mutex_lock(&w->lock);
    while (w->count == IN_LINE) pthread_cond_wait(&w->changed, &w->lock);
    w->line[(w->first + w->count++) % IN_LINE] = job;
    const int status = brunt_hand_on(error, &w->failure);
    pthread_cond_broadcast(&w->changed);
    pthread_mutex_unlock(&w->lock);
    return status;
}

int brunt_writer_wait(brunt_writer *w, brunt_error *error) {
    pthread_mutex_lock(&w->lock);
    while (w->count) pthread_cond_wait(&w->changed, &w->lock);
    const int status = brunt_hand_on(error, &w->failure);
    w->failure.code = BRUNT_OK;
    pthread_mutex_unlock(&w->lock);
    return status;
}

bool brunt_writer_failed(brunt_writer *w) {
    pthread_mutex_lock(&w->lock);
    const bool failed = w->failure.code != BRUNT_OK;
    pthread_mutex_unlock(&w->lock);
    return failed;
}
