#include "driver/async/worker.hpp"

#include <pthread.h>

namespace sweepcast::async {

Worker::Worker(std::string name, TaskGroup::OnFailure on_failure)
    : busy_(context_.get_executor())
    , tasks_(context_.get_executor(), std::move(on_failure))
    , thread_([this] { context_.run(); }) {
    name.resize(std::min<std::size_t>(name.size(), 15));  // the kernel's limit
    pthread_setname_np(thread_.native_handle(), name.c_str());
}

Worker::~Worker() {
    stop();
}

void Worker::stop() {
    context_.stop();
    if (thread_.joinable()) {
        thread_.join();
    }
}

}  // namespace sweepcast::async
