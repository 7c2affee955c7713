// Result<T>: what a function that can fail in an expected way gives back; Problem: a failure that a
// person will read.
#pragma once

#include <boost/system/error_code.hpp>
#include <boost/system/result.hpp>

#include <string>

namespace sweepcast {

using boost::system::error_code;

/// A value or an error. As boost::system::result, but the compiler complains when it is dropped.
template <class T, class E = error_code>
struct [[nodiscard]] Result : boost::system::result<T, E> {
    using boost::system::result<T, E>::result;
};

/// A failure as an operator should read it: what happened, with the values of this case, and the
/// next step.
struct Problem {
    error_code code;
    std::string cause;  ///< e.g. "/dev/ttyUSB0 is held by ModemManager (process 812)"
    std::string hint;   ///< e.g. "stop it: systemctl stop ModemManager"
};

}  // namespace sweepcast
