// The serial ports of this machine, as sysfs knows them.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace sweepcast::link {

/// A serial port behind a USB adapter.
struct SerialPort {
    std::string path;   ///< e.g. "/dev/ttyUSB0"; changes with the order of plugging in
    std::string by_id;  ///< e.g. "/dev/serial/by-id/usb-Silicon_Labs_..."; empty if udev made none
    std::string by_path;  ///< names the socket it is plugged into; empty if udev made none
    std::uint16_t vendor_id{};
    std::uint16_t product_id{};
    std::string driver;   ///< of the kernel, e.g. "cp210x"
    std::string product;  ///< as the adapter calls itself
    std::string serial;   ///< of the adapter; often the same on all of them ("0001")
    bool operator==(const SerialPort&) const = default;
};

/// Where the system keeps its devices; tests use a tree of their own.
struct SystemRoots {
    std::filesystem::path sysfs{"/sys"};
    std::filesystem::path dev{"/dev"};
};

/// All serial ports behind USB adapters that have a device file, sorted by path. What cannot be
/// read is left out. Texts that adapters give are made printable.
std::vector<SerialPort> list_usb_ports(const SystemRoots& roots = {});

/// Those behind an adapter that RPLIDARs are sold with (CP210x, CH34x): where a lidar may be looked
/// for.
std::vector<SerialPort> list_candidate_ports(const SystemRoots& roots = {});

/// Whether RPLIDARs are sold with this USB adapter.
bool is_lidar_adapter(std::uint16_t vendor_id, std::uint16_t product_id);

}  // namespace sweepcast::link
