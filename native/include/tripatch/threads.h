// How many threads fills work on.
#pragma once

namespace tripatch {

/// Threads that work at a time, the caller's own among them: as many as cores, or fewer if the environment's TRIPATCH_THREADS says so.
int max_threads();

/// From now on n threads work at a time for each caller, more than cores too; 0: as many as at first. No result depends on it.
void set_threads(int n);

}  // namespace tripatch
