// Worker: one thread with an io_context and the owner of the coroutines that live on it.
#pragma once

#include "driver/async/task_group.hpp"

#include <boost/asio/awaitable.hpp>
#include <boost/asio/bind_cancellation_slot.hpp>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/use_awaitable.hpp>

#include <string>
#include <thread>

namespace sweepcast::async {

/// A thread that runs one io_context until told to stop. What lives on a worker is touched by that
/// worker's thread only: no locks, no strands.
class Worker {
public:
    /// Starts the thread. `name` is what debuggers and top(1) show (at most 15 characters).
    Worker(std::string name, TaskGroup::OnFailure on_failure);
    /// Stops and joins.
    ~Worker();
    Worker(const Worker&) = delete;
    Worker& operator=(const Worker&) = delete;

    [[nodiscard]] boost::asio::io_context::executor_type executor() {
        return context_.get_executor();
    }
    /// The coroutines of this worker. To be used on its thread only.
    [[nodiscard]] TaskGroup& tasks() { return tasks_; }

    /// Ends the thread; coroutines still suspended are destroyed with the worker.
    void stop();

private:
    boost::asio::io_context context_{1};
    boost::asio::executor_work_guard<boost::asio::io_context::executor_type> busy_;
    TaskGroup tasks_;
    std::thread thread_;
};

/// Runs `task` on another executor and resumes the caller on its own with the result. The task
/// cannot be cancelled from here: a signal emitted on a foreign thread would race with it.
template <class T, class Executor>
boost::asio::awaitable<T> run_on(Executor executor, boost::asio::awaitable<T> task) {
    namespace asio = boost::asio;
    co_return co_await asio::co_spawn(
        executor,
        std::move(task),
        asio::bind_cancellation_slot(asio::cancellation_slot{}, asio::use_awaitable)
    );
}

}  // namespace sweepcast::async
