// Boost.JSON, compiled once for all tests: it is used header-only.
#include <boost/json/src.hpp>
