#pragma once
// What an MPI message between the coupler and a server is.

namespace couplet::wire {

inline constexpr int mpi_head_tag =
    1;  // sizes of the frames that follow, 64-bit integers; one negative number: the end
inline constexpr int mpi_frame_tag = 2;  // one frame
inline constexpr int mpi_beat_tag = 3;   // empty: a sign of life

}  // namespace couplet::wire
