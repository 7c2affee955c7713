// Cases that pass, fail, skip themselves, crash, hang or leak, as PLANTED says. For
// run_cases_test.py.
#include <gtest/gtest.h>

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <spawn.h>
#include <string>
#include <sys/wait.h>
#include <unistd.h>

extern char** environ;

namespace {

bool planted(const std::string& what) {
    const char* wanted = std::getenv("PLANTED");
    return wanted != nullptr && what == wanted;
}

// Volatile, so that no compiler sees through it.
int* volatile lost = nullptr;

void leak() {
    lost = new int(1);
    lost = nullptr;
}

int use_after_free() {
    lost = new int(1);
    int* volatile const kept = lost;
    delete lost;
    lost = nullptr;
    return *kept;
}

/// Runs this program again with something else planted, and does not look at how it ends.
void run_child(const char* what) {
    setenv("PLANTED", what, 1);
    pid_t child = 0;
    std::string program = "/proc/self/exe";
    std::string filter = "--gtest_filter=Planted.*";
    char* arguments[] = {program.data(), filter.data(), nullptr};
    ASSERT_EQ(posix_spawn(&child, arguments[0], nullptr, nullptr, arguments, environ), 0);
    waitpid(child, nullptr, 0);
}

TEST(Before, Passes) {}

TEST(Planted, Case) {
    if (planted("failure")) {
        ADD_FAILURE() << "as planted";
    } else if (planted("skip")) {
        GTEST_SKIP();
    } else if (planted("crash")) {
        std::raise(SIGSEGV);
    } else if (planted("hang")) {
        pause();
    } else if (planted("noisy hang")) {
        for (;;) {
            std::puts("still here");
            std::fflush(stdout);
        }
    } else if (planted("leak")) {
        leak();
    } else if (planted("use after free")) {
        EXPECT_NE(use_after_free(), 2);
    } else if (planted("leak in a child")) {
        run_child("leak");
    } else if (planted("use after free in a child")) {
        run_child("use after free");
    } else if (planted("end")) {
        std::_Exit(0);
    }
}

TEST(After, Passes) {}

}  // namespace
