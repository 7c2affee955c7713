// Prints the nearest echo of three sweeps, as somebody else's program would.
#include <algorithm>
#include <iostream>
#include <sweepcast/blocking_client.hpp>

int main(int argc, char** argv) {
    if (argc != 2) {
        std::cerr << "usage: consumer URL, such as tcp://127.0.0.1:8081\n";
        return 2;
    }
    const auto url = sweepcast::client::parse_stream_url(argv[1]);
    if (!url) {
        std::cerr << url.error().cause << ": " << url.error().hint << "\n";
        return 2;
    }
    sweepcast::client::ClientOptions options;
    options.reconnect = sweepcast::client::Reconnect::once_connected;
    options.wish->set_min_distance_mm(50);
    sweepcast::client::BlockingClient client(*url, options);
    for (int sweeps = 0; sweeps < 3;) {
        const auto event = client.next();
        if (!event) {
            std::cerr << event.error().cause << ": " << event.error().hint << "\n";
            return 1;
        }
        const auto* scan = std::get_if<sweepcast::client::Scan>(&*event);
        if (scan == nullptr) continue;
        ++sweeps;
        auto echoes = scan->scan.sweep.samples;
        std::erase_if(echoes, [](const auto& sample) { return !sample.distance.has_echo(); });
        const auto nearest = std::ranges::min_element(echoes, {}, [](const auto& sample) {
            return sample.distance.millimetres();
        });
        std::cout << "lidar " << scan->lidar << " sweep " << scan->sequence << ": "
                  << scan->scan.sweep.samples.size() << " samples";
        if (nearest != echoes.end()) {
            std::cout << ", nearest " << nearest->distance.millimetres() << " mm at "
                      << scan->scan.degrees(*nearest) << " degrees";
        }
        std::cout << std::endl;
    }
}
