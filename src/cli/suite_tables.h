// SPDX-License-Identifier: Apache-2.0
// The tables of the paper's evaluation (Liu and Miura 2021, section VII) from a suite's results.
#pragma once

#include <string>
#include <vector>

#include "cli/suite.h"
#include "cli/suite_results.h"

namespace rds {

struct TableCell {
  std::string value;
  std::string aside;  // in small print
};

struct ReportTable {
  std::string file;  // name for its CSV, without extension
  std::string title;
  std::string note;
  std::vector<std::string> headings;
  std::vector<std::vector<TableCell>> rows;  // the first cell names the row
};

// Tables 1 to 3: ATE, RPE in translation and in rotation. A row for each method, for all frames and for keyframes, and
// for each published one; a column for each sequence. RMSE / standard deviation, medians over runs, and the least and
// greatest RMSE.
[[nodiscard]] std::vector<ReportTable> ErrorTables(const Suite& suite, const std::vector<MethodResults>& results);

// Table 4: times of each stage, medians in milliseconds, here and as published.
[[nodiscard]] ReportTable TimeTable(const Suite& suite, const std::vector<MethodResults>& results);

// Table 5: how many keyframes were labeled.
[[nodiscard]] ReportTable KeyframeTable(const Suite& suite, const std::vector<MethodResults>& results);

// Every run's errors, a line each, for other programs.
[[nodiscard]] std::string ErrorsCsv(const Suite& suite, const std::vector<MethodResults>& results);

// "Intel Xeon ..., 2 cores".
[[nodiscard]] std::string ThisMachine();

[[nodiscard]] std::string ToMarkdown(const ReportTable& table);
[[nodiscard]] std::string ToHtml(const ReportTable& table);
[[nodiscard]] std::string ToCsv(const ReportTable& table);
[[nodiscard]] std::string HtmlText(std::string_view text);  // escaped

}  // namespace rds
