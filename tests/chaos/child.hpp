// The programs under chaos, as child processes: virtual lidars that obey, and the gateway.
#pragma once

#include "driver/virtual/persona.hpp"
#include "tests/e2e/gateway.hpp"
#include "tests/support/process.hpp"

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

namespace sweepcast::chaos {

/// `sweepcast virtual`, told what to suffer through its control socket.
class Lidar {
public:
    /// What it measures it writes to a FIFO, which someone must read.
    Lidar(const test::ScratchDirectory& scratch, std::string model, std::size_t number);
    ~Lidar();
    Lidar(const Lidar&) = delete;
    Lidar& operator=(const Lidar&) = delete;

    /// Waits until it takes commands.
    void wait_until_ready() const;
    /// Tells it. Empty if it answers ok, else what it answers. Throws if it does not answer.
    [[nodiscard]] std::string tell(const std::string& command) const;

    [[nodiscard]] const std::string& model() const { return model_; }
    [[nodiscard]] const std::string& link() const { return link_; }
    [[nodiscard]] int truth() const { return truth_; }  ///< the reading end of the FIFO
    [[nodiscard]] const virtual_lidar::Persona& persona() const { return *persona_; }

private:
    std::string model_;
    const virtual_lidar::Persona* persona_;
    std::string link_;
    std::string control_;
    int truth_{-1};
    std::unique_ptr<test::Process> process_;
};

/// `sweepcast serve` of these lidars.
class Gateway {
public:
    Gateway(const test::ScratchDirectory& scratch, const std::vector<std::string>& links);

    [[nodiscard]] const std::string& http() const { return http_; }
    [[nodiscard]] const std::string& tcp() const { return tcp_; }
    [[nodiscard]] bool lives() const;
    [[nodiscard]] std::size_t descriptors() const;
    [[nodiscard]] std::size_t resident_bytes() const { return process_->resident_bytes(); }
    /// The last lines that it wrote.
    [[nodiscard]] std::string log_tail() const;
    /// Tells it to end, and gives its exit code.
    int stop();

private:
    std::string log_;
    std::unique_ptr<test::Process> process_;
    std::string http_;
    std::string tcp_;
};

/// Virtual lidars of four families in turn, and a gateway of all of them.
struct Rig {
    /// Starts them, and waits until the lidars take commands and the gateway listens.
    explicit Rig(std::size_t count);

    test::ScratchDirectory scratch;
    std::vector<std::unique_ptr<Lidar>> lidars;
    std::unique_ptr<Gateway> gateway;
};

}  // namespace sweepcast::chaos
