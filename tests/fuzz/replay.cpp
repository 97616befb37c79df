// Runs a fuzzer without libFuzzer: on files (inputs that were found, a corpus), or on so many random inputs from a seed.
//   fuzz_... FILE...    or    fuzz_... --random COUNT [SEED]
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace {

void run_random(long count, unsigned seed) {
  for (long k = 0; k < count; ++k) {
    std::mt19937 random(seed + static_cast<unsigned>(k));
    std::vector<std::uint8_t> bytes(random() % 1024);
    for (std::uint8_t& b : bytes) b = static_cast<std::uint8_t>(random());
    // told before it is run, so that the last line says which did not come back
    std::printf("\r--random 1 %ld", static_cast<long>(seed) + k);
    std::fflush(stdout);
    LLVMFuzzerTestOneInput(bytes.data(), bytes.size());
  }
  std::printf("\n%ld inputs\n", count);
}

}  // namespace

int main(int count, char** words) {
  if (count > 2 && std::strcmp(words[1], "--random") == 0) {
    run_random(std::stol(words[2]), count > 3 ? static_cast<unsigned>(std::stoul(words[3])) : 0);
    return 0;
  }
  for (int k = 1; k < count; ++k) {
    std::ifstream file(words[k], std::ios::binary);
    const std::vector<char> bytes((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
    std::printf("%s\n", words[k]);
    std::fflush(stdout);
    LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
  }
  return 0;
}
