// SPDX-License-Identifier: Apache-2.0
#include "cli/process_info.h"

#include <sys/resource.h>
#include <unistd.h>

#include <fstream>
#include <sstream>
#include <string>

#include "base/time.h"

namespace rds {
namespace {

// For systems without /proc: time since the program's static initialization.
const Stopwatch since_initialization;

// Field 22 of /proc/self/stat: start of the process in ticks after the start of the machine. 0 = unknown.
double ProcessStartAfterBoot() {
  std::ifstream file("/proc/self/stat");
  std::string stat;
  std::getline(file, stat);
  const std::size_t end_of_name = stat.rfind(')');  // the name may contain blanks
  if (end_of_name == std::string::npos) {
    return 0;
  }
  std::istringstream fields(stat.substr(end_of_name + 1));
  std::string skipped;
  for (int field = 3; field < 22; ++field) {
    fields >> skipped;
  }
  double ticks = 0;
  fields >> ticks;
  return ticks / static_cast<double>(sysconf(_SC_CLK_TCK));
}

}  // namespace

double SecondsSinceProcessStart() {
  const double start = ProcessStartAfterBoot();
  const double elapsed = CpuSeconds(CLOCK_BOOTTIME) - start;
  // A container may have a clock of its own that does not fit the tick count.
  const bool plausible =
      start > 0 && elapsed >= since_initialization.Seconds() && elapsed < since_initialization.Seconds() + 60;
  return plausible ? elapsed : since_initialization.Seconds();
}

double PeakMemoryMb() {
  std::ifstream file("/proc/self/status");
  std::string name;
  while (file >> name) {
    if (name == "VmHWM:") {
      double kibibytes = 0;
      file >> kibibytes;
      return kibibytes * 1024e-6;
    }
    std::getline(file, name);
  }
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) * 1024e-6;
}

}  // namespace rds
