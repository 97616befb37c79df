/* Lets one write of a process fail as on a full disk: LD_PRELOAD it, and call fail_at. With glibc. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <stdatomic.h>
#include <stdio.h>
#include <sys/types.h>
#include <unistd.h>

static atomic_long left = -1, seen = 0;

/* From now on the k-th write fails, counted from 0, and none where k < 0. Gives the number of writes since the call before. */
long fail_at(long k) {
  atomic_store(&left, k);
  return atomic_exchange(&seen, 0);
}

static int fails(void) {
  atomic_fetch_add(&seen, 1);
  if (atomic_load(&left) < 0 || atomic_fetch_sub(&left, 1) != 0) return 0;
  errno = ENOSPC;
  return 1;
}

ssize_t write(int file, const void* data, size_t size) {
  static ssize_t (*own)(int, const void*, size_t);
  if (!own) own = dlsym(RTLD_NEXT, "write");
  return fails() ? -1 : own(file, data, size);
}

size_t fwrite(const void* data, size_t size, size_t count, FILE* file) {
  static size_t (*own)(const void*, size_t, size_t, FILE*);
  if (!own) own = dlsym(RTLD_NEXT, "fwrite");
  return fails() ? 0 : own(data, size, count, file);
}
