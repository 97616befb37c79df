#include "tripatch/math/parallel.h"

#if defined(__unix__) || defined(__APPLE__)
#include <pthread.h>
#endif
#if defined(__x86_64__) || defined(_M_X64)
#include <immintrin.h>
#endif

#include <chrono>
#include <condition_variable>
#include <cstdlib>
#include <mutex>
#include <thread>
#include <vector>

#include "tripatch/math/thresholds.h"
#include "tripatch/threads.h"

namespace tripatch {

namespace {

/// A thread looks so long whether there is work, or whether it is done, before it sleeps: to be woken takes 20 us or more.
constexpr std::chrono::microseconds looks_for{100};
constexpr std::chrono::milliseconds between_looks{20};

thread_local bool is_serial = false, is_of_pool = false;

std::atomic<int> threads_set = 0;

/// As many as cores, or as the environment says where several processes share these.
int default_threads() {
  static const int most = [] {
    const int cores = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
    const char* given = std::getenv("TRIPATCH_THREADS");
    const int threads = given ? std::atoi(given) : 0;
    return threads > 0 ? std::min(cores, threads) : cores;
  }();
  return most;
}

/// A moment in which a core that works for two threads is the other's.
void rest() {
#if defined(__x86_64__) || defined(_M_X64)
  _mm_pause();
#elif defined(__aarch64__) && defined(__GNUC__)
  asm volatile("yield");
#endif
}

/// Looks whether `known()` for a while; gives what it knows.
template <class Known>
bool looked_for(const Known& known) {
  using Clock = std::chrono::steady_clock;
  constexpr int looks = count::hundred;
  for (const Clock::time_point end = Clock::now() + looks_for; Clock::now() < end; std::this_thread::yield())
    for (int k = 0; k < looks; ++k, rest())
      if (known()) return true;
  return known();
}

}  // namespace

int max_threads() {
  const int set = threads_set;
  return set > 0 ? set : default_threads();
}

void set_threads(int n) { threads_set = std::max(n, 0); }

bool may_share() { return !is_serial && max_threads() > 1; }

SerialScope::SerialScope(bool serial) : before_(std::exchange(is_serial, is_serial || serial)) {}
SerialScope::~SerialScope() { is_serial = before_; }

/// Threads that take up pieces of jobs, begun when they are needed. They are never ended: what is left of them at the end of the process sleeps.
class ThreadPool {
public:
  /// That of this process: after a fork the threads of the one that was forked are not here, so there is another.
  static ThreadPool& here() {
    static const bool knows_forks = [] {
#if defined(__unix__) || defined(__APPLE__)
      return pthread_atfork(nullptr, nullptr, [] { only = nullptr; }) == 0;
#else
      return true;
#endif
    }();
    static_cast<void>(knows_forks);
    ThreadPool* pool = only;
    if (pool) return *pool;
    auto* const made = new ThreadPool;
    if (only.compare_exchange_strong(pool, made)) return *made;
    delete made;
    return *pool;
  }

  Index at_work() const { return at_work_; }

  void begin(Job& job) {
    const std::lock_guard lock(mutex_);
    const Index wanted = std::min(job.options_.max_helpers, job.count_);
    const Index most = std::max<Index>(max_threads(), job.options_.max_helpers);
    for (Index idle = threads_ - at_work_; idle < wanted && threads_ < most; ++idle, ++threads_)
      std::thread([this] { work(); }).detach();
    jobs_.push_back(&job);
    ++changes_;
    for (Index k = std::min(wanted, sleeping_); k > 0; --k) begun_.notify_one();
  }

  /// Nothing of the job is begun any more.
  void withdraw(Job& job) {
    const std::lock_guard lock(mutex_);
    job.next_ = job.count_;
    std::erase(jobs_, &job);
  }

  /// Whether all of the job is done, looked for some time.
  bool is_done(const Job& job) {
    const auto done = [&] { return job.next_ >= job.count_ && job.helpers_ == 0; };
    if (looked_for(done)) return true;
    std::unique_lock lock(mutex_);
    // by the system's clock: for the steady one the C++ library asks glibc for a function that 2.17 has not
    return left_.wait_until(lock, std::chrono::system_clock::now() + between_looks, done);
  }

  std::mutex& mutex() { return mutex_; }

private:
  Job* next_job() {
    for (Job* job : jobs_)
      if (job->helpers_ < job->options_.max_helpers && job->next_ < job->count_) return job;
    return nullptr;
  }

  void work() {
    is_of_pool = true;
    std::unique_lock lock(mutex_);
    for (;;) {
      Job* const job = next_job();
      if (!job) {
        const unsigned seen = changes_;
        lock.unlock();
        const bool changed = looked_for([&] { return changes_ != seen; });
        lock.lock();
        if (changed || changes_ != seen) continue;
        ++sleeping_;
        begun_.wait(lock, [&] { return changes_ != seen; });
        --sleeping_;
        continue;
      }
      ++job->helpers_;
      ++at_work_;
      lock.unlock();
      {
        const CancelScope cancel(job->options_.cancel);
        const SerialScope serial(job->options_.serial);
        job->work();
      }
      lock.lock();
      --at_work_;
      --job->helpers_;
      left_.notify_all();
    }
  }

  static inline std::atomic<ThreadPool*> only = nullptr;

  std::mutex mutex_;  // of changes of what follows, and of what jobs say of it
  std::condition_variable begun_, left_;
  std::vector<Job*> jobs_;
  Index threads_ = 0, sleeping_ = 0;
  std::atomic<Index> at_work_ = 0;
  std::atomic<unsigned> changes_ = 0;
};

Index free_threads() { return may_share() ? 1 + std::max<Index>(max_threads() - 1 - ThreadPool::here().at_work(), 0) : 1; }

Job::Job(Index count, Piece piece, const Options& options) : piece_(std::move(piece)), count_(count), options_(options) {
  ThreadPool::here().begin(*this);
}

Job::~Job() {
  ThreadPool& pool = ThreadPool::here();
  pool.withdraw(*this);
  while (!pool.is_done(*this)) continue;
}

void Job::work() {
  for (Index k = next_++; k < count_; k = next_++) {
    try {
      piece_(k);
    } catch (const Interrupted&) {
      fail(k, true);
    } catch (...) {
      fail(k, false);
    }
  }
}

void Job::fail(Index piece, bool interrupted) {
  const std::lock_guard lock(ThreadPool::here().mutex());
  next_ = count_;
  const std::pair at(interrupted, piece);
  if (failure_ && failed_at_ < at) return;
  failure_ = std::current_exception();
  failed_at_ = at;
}

void Job::finish(bool works, const std::function<void()>& waiting) {
  if (works) work();
  for (bool waits = true; !ThreadPool::here().is_done(*this);) {
    try {
      if (waits) waiting();
    } catch (const Interrupted&) {
      waits = false;
      fail(-1, true);
    } catch (...) {
      waits = false;
      fail(-1, false);
    }
  }
  if (failure_) std::rethrow_exception(failure_);
}

void parallel_for_each(std::size_t count, const std::function<void(std::size_t)>& f,
                       const std::function<void(std::size_t)>& progress) {
  const bool is_inner = is_serial || is_of_pool;  // whose thread works itself: others may wait for the same
  std::atomic<std::size_t> done = 0;
  Cancel stop;
  const auto piece = [&](Index k) {
    try {
      f(static_cast<std::size_t>(k));
      ++done;
    } catch (...) {
      stop.request();
      throw;
    }
  };
  const auto tell = [&] {
    try {
      check_interruption();
      progress(done);
    } catch (...) {
      stop.request();
      throw;
    }
  };
  const Index helpers = is_inner ? 0 : max_threads();
  Job(static_cast<Index>(count), piece, {.max_helpers = helpers, .serial = count > 1, .cancel = &stop}).finish(is_inner, tell);
  progress(done);
}

}  // namespace tripatch
