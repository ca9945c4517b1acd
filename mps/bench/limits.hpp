// What one core of this machine can do at most.
#pragma once

namespace embacle::mps::bench {

/// Peak of fused multiply-adds in double precision, with vectors as the sweeps use them [flop/s].
double peak_flops();
/// Bandwidth of a[i] = b[i] + s c[i] far beyond the caches, 24 bytes counted an element [bytes/s].
double triad_bandwidth();

}  // namespace embacle::mps::bench
