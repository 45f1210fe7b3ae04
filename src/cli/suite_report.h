// SPDX-License-Identifier: Apache-2.0
// The report of a suite: report.md, report.html and tables as CSV.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "cli/suite.h"
#include "cli/suite_results.h"

namespace rds {

// Writes report.md, report.html (one file with its pictures in it, for any browser), errors.csv, a CSV for each table
// and the plots that report.md shows (figures/*.svg). `problems` are said at the top.
void WriteSuiteReport(const Suite& suite, const std::vector<MethodResults>& results,
                      const std::vector<std::string>& problems, const std::filesystem::path& out);

}  // namespace rds
