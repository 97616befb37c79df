/* Counts requests and lets one of them fail. */
#include <errno.h>
#include <stdatomic.h>

static atomic_long left = -1, seen = 0;

/* From now on the k-th request fails, counted from 0, and none where k < 0. Gives the number of requests since the call before. */
long fail_at(long k) {
  atomic_store(&left, k);
  return atomic_exchange(&seen, 0);
}

static int fails(int error) {
  atomic_fetch_add(&seen, 1);
  if (atomic_load(&left) < 0 || atomic_fetch_sub(&left, 1) != 0) return 0;
  errno = error;
  return 1;
}
