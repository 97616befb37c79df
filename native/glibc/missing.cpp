// What GCC's C++ library asks of glibc and 2.17 has not, for a module that has that library inside: native/cmake/old_glibc.cmake.
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cstdlib>

extern "C" {

// Counts of shared pointers are always atomic.
extern char __libc_single_threaded;
char __libc_single_threaded = 0;

// The rest comes along with strings and streams; nothing of ours calls it.
int __fxstat64(int version, int file, struct stat64* status);
int fstat64(int file, struct stat64* status) { return __fxstat64(1, file, status); }

int getentropy(void* bytes, size_t count) { return syscall(SYS_getrandom, bytes, count, 0) == long(count) ? 0 : -1; }

unsigned arc4random() {
  unsigned bits;
  if (getentropy(&bits, sizeof bits) != 0) std::abort();
  return bits;
}
}
