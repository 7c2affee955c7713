#include "driver/async/task_group.hpp"

#include <boost/asio/bind_cancellation_slot.hpp>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/redirect_error.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <boost/system/system_error.hpp>

namespace sweepcast::async {

namespace asio = boost::asio;

bool is_cancellation(const std::exception_ptr& failure) {
    try {
        std::rethrow_exception(failure);
    } catch (const boost::system::system_error& e) {
        return e.code() == asio::error::operation_aborted;
    } catch (...) {  // the caller reports it
        return false;
    }
}

TaskGroup::TaskGroup(asio::any_io_executor executor, OnFailure on_failure)
    : executor_(executor)
    , on_failure_(std::move(on_failure))
    , emptied_(executor) {
    emptied_.expires_at(std::chrono::steady_clock::time_point::max());
}

void TaskGroup::spawn(asio::awaitable<void> task) {
    const auto entry = running_.emplace(running_.end());
    auto on_exit = [this, entry](std::exception_ptr failure) {
        running_.erase(entry);
        if (failure && !is_cancellation(failure)) {
            on_failure_(failure);
        }
        if (running_.empty()) {
            emptied_.cancel();
        }
    };
    asio::co_spawn(
        executor_,
        std::move(task),
        asio::bind_cancellation_slot(entry->slot(), std::move(on_exit))
    );
}

void TaskGroup::cancel() {
    // Emitting may end a coroutine at once and so erase its entry: step on before emitting.
    for (auto entry = running_.begin(); entry != running_.end();) {
        auto& signal = *entry++;
        signal.emit(asio::cancellation_type::terminal);
    }
}

asio::awaitable<bool> TaskGroup::join(std::chrono::steady_clock::duration limit) {
    if (!running_.empty()) {
        emptied_.expires_after(limit);
        boost::system::error_code
            ignored;  // cancelled when the last one ends, success when the limit passes
        co_await emptied_.async_wait(asio::redirect_error(asio::use_awaitable, ignored));
        emptied_.expires_at(std::chrono::steady_clock::time_point::max());
    }
    co_return running_.empty();
}

}  // namespace sweepcast::async
