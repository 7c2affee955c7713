#include "driver/async/notifier.hpp"

#include <boost/asio/redirect_error.hpp>
#include <boost/asio/use_awaitable.hpp>

namespace sweepcast::async {

namespace asio = boost::asio;

void Notifier::notify() {
    for (auto* timer : waiting_) {
        timer->cancel();
    }
}

asio::awaitable<bool> Notifier::wait_until(std::chrono::steady_clock::time_point deadline) {
    asio::steady_timer timer(executor_, deadline);
    const auto entry = waiting_.insert(waiting_.end(), &timer);
    struct Leave {
        std::list<asio::steady_timer*>& waiting;
        std::list<asio::steady_timer*>::iterator entry;
        ~Leave() { waiting.erase(entry); }
    } leave{waiting_, entry};

    boost::system::error_code woken;
    co_await timer.async_wait(asio::redirect_error(asio::use_awaitable, woken));
    co_return woken == asio::error::operation_aborted;
}

}  // namespace sweepcast::async
