#pragma once
// Arrays of the same sizes come and go with every message. Unless told otherwise, the C library gives large blocks back
// to the system at once and gets them again page by page, which costs more than sending them.

namespace couplet::wire {

/// From now on memory that is freed stays with this process for the next array. A program that opens a channel calls it
/// (each channel between processes does); calling it again changes nothing.
void keep_freed_memory();

}  // namespace couplet::wire
