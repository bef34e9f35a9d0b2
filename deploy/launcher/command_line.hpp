#pragma once
// The command line of couplet: which verbs there are and what each takes.

namespace couplet::launcher {

/// Does what the command line asks for and returns the exit code. Throws SceneError in one line, naming the nearest
/// verb or option, when it cannot be understood.
int run_command_line(int argc, char** argv);

}  // namespace couplet::launcher
