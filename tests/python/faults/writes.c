/* Lets one write of a process fail as on a full disk: LD_PRELOAD it, and call fail_at. With glibc. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <stdio.h>
#include <sys/types.h>
#include <unistd.h>

#include "fail_at.h"

ssize_t write(int file, const void* data, size_t size) {
  static ssize_t (*own)(int, const void*, size_t);
  if (!own) own = dlsym(RTLD_NEXT, "write");
  return fails(ENOSPC) ? -1 : own(file, data, size);
}

size_t fwrite(const void* data, size_t size, size_t count, FILE* file) {
  static size_t (*own)(const void*, size_t, size_t, FILE*);
  if (!own) own = dlsym(RTLD_NEXT, "fwrite");
  return fails(ENOSPC) ? 0 : own(data, size, count, file);
}
