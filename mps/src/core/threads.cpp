#include "core/threads.hpp"

namespace embacle::mps {

namespace {
int count_of_threads = 1;
}

int threads() { return count_of_threads; }
void set_threads(int count) { count_of_threads = count; }

}  // namespace embacle::mps
