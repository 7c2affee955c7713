#include "server/api/request.hpp"

#include <boost/url/parse.hpp>
#include <boost/url/url_view.hpp>

#include <algorithm>

namespace sweepcast::api {

std::string_view Request::parameter(std::string_view key) const {
    const auto found = std::ranges::find(query, key, [](const auto& entry) {
        return std::string_view(entry.first);
    });
    return found == query.end() ? std::string_view{} : std::string_view(found->second);
}

bool set_target(Request& request, std::string_view target) {
    const auto url = boost::urls::parse_origin_form(target);
    if (!url) {
        return false;
    }
    request.path = url->path();
    request.query.clear();
    for (const auto& parameter : url->params()) {
        request.query.emplace_back(parameter.key, parameter.value);
    }
    return true;
}

bool same_origin(std::string_view origin, std::string_view host) {
    if (origin.empty()) {
        return true;
    }
    const auto scheme_end = origin.find("://");
    return scheme_end != std::string_view::npos && origin.substr(scheme_end + 3) == host;
}

}  // namespace sweepcast::api
