// HostNames: the names under which clients may address the gateway.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace sweepcast::http {

/// What the Host header of a request says.
enum class HostCheck : std::uint8_t {
    ours,       ///< an address, or a name of this gateway
    other,      ///< a name that this gateway does not have
    malformed,  ///< neither a name nor an address, or the port is no number
};

/// Decides by the Host header whether a request was meant for this gateway. Any web site can have
/// its own name resolved to the gateway's address (DNS rebinding); a browser then takes the
/// gateway for that site and lets the site's page control the lidars. Such requests carry the
/// site's name. A request to an IP address is safe because DNS takes no part in it. A request to
/// "localhost" is safe because it never leaves the machine.
class HostNames {
public:
    /// Takes the names that are allowed besides addresses, localhost and *.localhost.
    explicit HostNames(std::vector<std::string> names);

    /// Checks a Host header such as "robot:8080" or "[::1]:8080". Upper case and a dot at the end
    /// of a name make no difference, nor does the port.
    [[nodiscard]] HostCheck check(std::string_view header) const;

private:
    std::vector<std::string> names_;  ///< in lower case, without a dot at the end
};

/// Returns whether `text` can be a host name: parts of letters, digits, '-' and '_' with dots
/// between them, 253 characters at most.
[[nodiscard]] bool is_host_name(std::string_view text);

/// Returns the names of a machine with this host name: the host name, its first part, and
/// FIRST_PART.local, the machine's name in multicast DNS. All are in lower case, without a dot at
/// the end. Returns no names if `host_name` cannot be a host name.
[[nodiscard]] std::vector<std::string> names_of(std::string_view host_name);

/// Returns names_of() the host name of this machine.
[[nodiscard]] std::vector<std::string> own_host_names();

}  // namespace sweepcast::http
