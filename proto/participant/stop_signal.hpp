#pragma once
// SIGTERM and SIGINT as a question that a program asks itself between two pieces of work.

namespace couplet::participant {

/// From now on the first SIGTERM or SIGINT only makes stop_was_asked() true; a second one ends the program at once.
void catch_stop_signals();

bool stop_was_asked();

}  // namespace couplet::participant
