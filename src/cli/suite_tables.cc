// SPDX-License-Identifier: Apache-2.0
#include "cli/suite_tables.h"

#include <spdlog/fmt/fmt.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <optional>

#include "eval/statistics.h"

namespace rds {
namespace {

struct ErrorKind {
  const char* file;
  const char* title;
  double RunErrors::*rmse;
  double RunErrors::*std;
  std::map<std::string, PublishedValue> PublishedMethod::*published;
};

constexpr const char* kErrorNote =
    "RMSE / standard deviation over a trajectory: medians of the runs, and in small print the least and greatest RMSE; "
    "a "
    "share of frames where not all were tracked.";

const std::array kErrorKinds = {
    ErrorKind{"ate", "Absolute trajectory error [m]", &RunErrors::ate_rmse_m, &RunErrors::ate_std_m,
              &PublishedMethod::ate_m},
    ErrorKind{"rpe_translation", "Relative pose error over 1 s, translation [m]", &RunErrors::rpe_translation_rmse_m,
              &RunErrors::rpe_translation_std_m, &PublishedMethod::rpe_translation_m},
    ErrorKind{"rpe_rotation", "Relative pose error over 1 s, rotation [deg]", &RunErrors::rpe_rotation_rmse_deg,
              &RunErrors::rpe_rotation_std_deg, &PublishedMethod::rpe_rotation_deg},
};

double MedianOf(const std::vector<RunErrors>& runs, double RunErrors::*member) {
  std::vector<double> values;
  std::ranges::transform(runs, std::back_inserter(values), [member](const RunErrors& run) { return run.*member; });
  return Summarize(values).median;
}

TableCell ErrorCell(const std::vector<RunErrors>& runs, const ErrorKind& kind, bool all_frames) {
  if (runs.empty()) {
    return {"-", ""};
  }
  TableCell cell{fmt::format("{:.4f} / {:.4f}", MedianOf(runs, kind.rmse), MedianOf(runs, kind.std)), ""};
  if (runs.size() > 1) {
    const auto [least, most] = std::ranges::minmax(runs, {}, kind.rmse);
    cell.aside = fmt::format("{:.4f} - {:.4f}", least.*kind.rmse, most.*kind.rmse);
  }
  std::vector<double> shares;
  for (const RunErrors& run : runs) {
    shares.push_back(static_cast<double>(run.poses) / static_cast<double>(std::max<std::size_t>(run.frames, 1)));
  }
  if (const double share = Summarize(shares).median; all_frames && share < 0.995) {
    cell.aside += fmt::format("{}{:.0f} % of frames", cell.aside.empty() ? "" : ", ", 100 * share);
  }
  return cell;
}

TableCell PublishedCell(const std::map<std::string, PublishedValue>& values, const std::string& sequence) {
  const auto value = values.find(sequence);
  if (value == values.end()) {
    return {"-", ""};
  }
  return {value->second.std ? fmt::format("{:.4f} / {:.4f}", value->second.rmse, *value->second.std)
                            : fmt::format("{:.4f}", value->second.rmse),
          ""};
}

// A number of report.json by its path, over all runs; nothing where none has it.
std::optional<double> MedianOf(const std::vector<const nlohmann::json*>& reports, const char* path) {
  std::vector<double> values;
  const nlohmann::json::json_pointer pointer(path);
  for (const nlohmann::json* report : reports) {
    if (report->contains(pointer) && report->at(pointer).is_number()) {
      values.push_back(report->at(pointer).get<double>());
    }
  }
  return values.empty() ? std::nullopt : std::optional(Summarize(values).median);
}

TableCell NumberCell(const std::optional<double>& value, int digits) {
  return {value ? fmt::format("{:.{}f}", *value, digits) : "-", ""};
}

std::vector<const nlohmann::json*> Pointers(const std::vector<nlohmann::json>& reports) {
  std::vector<const nlohmann::json*> pointers;
  for (const nlohmann::json& report : reports) {
    pointers.push_back(&report);
  }
  return pointers;
}

std::string CsvText(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) {
    return text;
  }
  std::string quoted = "\"";
  for (const char c : text) {
    quoted += c == '"' ? "\"\"" : std::string(1, c);
  }
  return quoted + "\"";
}

}  // namespace

std::vector<ReportTable> ErrorTables(const Suite& suite, const std::vector<MethodResults>& results) {
  std::vector<ReportTable> tables;
  for (const ErrorKind& kind : kErrorKinds) {
    ReportTable& table = tables.emplace_back(ReportTable{kind.file, kind.title, kErrorNote, {"method"}, {}});
    for (const SuiteSequence& sequence : suite.sequences) {
      table.headings.push_back(sequence.name);
    }
    for (const MethodResults& method : results) {
      for (const bool all_frames : {true, false}) {
        if (!all_frames && !method.is_own) {
          continue;
        }
        std::vector<TableCell>& row = table.rows.emplace_back();
        row.push_back({method.name, all_frames ? "" : "keyframes"});
        for (const SequenceResults& sequence : method.sequences) {
          row.push_back(ErrorCell(all_frames ? sequence.frames : sequence.keyframes, kind, all_frames));
        }
      }
    }
    for (const PublishedMethod& method : suite.published) {
      const auto& values = method.*kind.published;
      if (values.empty()) {
        continue;
      }
      std::vector<TableCell>& row = table.rows.emplace_back();
      row.push_back({method.name, "published: " + method.source});
      for (const SuiteSequence& sequence : suite.sequences) {
        row.push_back(PublishedCell(values, sequence.name));
      }
    }
  }
  return tables;
}

ReportTable TimeTable(const Suite& suite, const std::vector<MethodResults>& results) {
  ReportTable table{
      "times",
      "Execution time [ms]",
      "Medians over all sequences and runs of each run's median; tracking with its 95 % quantile in small "
      "print. Published times are those of the hardware named.",
      {"method", "hardware", "segmentation", "mask", "moving probability", "optimization", "track a frame"},
      {}};
  for (const MethodResults& method : results) {
    if (!method.is_own) {
      continue;
    }
    std::vector<const nlohmann::json*> reports;
    for (const SequenceResults& sequence : method.sequences) {
      const auto some = Pointers(sequence.reports);
      reports.insert(reports.end(), some.begin(), some.end());
    }
    TableCell track = NumberCell(MedianOf(reports, "/tracking_ms/median"), 1);
    track.aside = NumberCell(MedianOf(reports, "/tracking_ms/p95"), 1).value;
    table.rows.push_back({{method.name, ""},
                          {ThisMachine(), ""},
                          NumberCell(MedianOf(reports, "/semantics/segmentation_ms/median"), 1),
                          NumberCell(MedianOf(reports, "/semantics/mask_ms/median"), 2),
                          NumberCell(MedianOf(reports, "/semantics/update_ms/median"), 2),
                          NumberCell(MedianOf(reports, "/semantics/optimization_ms/median"), 2),
                          track});
  }
  for (const PublishedMethod& method : suite.published) {
    if (!method.track_ms.empty()) {
      table.rows.push_back({{method.name, "published: " + method.source},
                            {method.hardware.empty() ? "-" : method.hardware, method.semantics},
                            {method.segmentation_ms.empty() ? "-" : method.segmentation_ms, ""},
                            {"-", method.other_ms},
                            {"", ""},
                            {"", ""},
                            {method.track_ms, ""}});
    }
  }
  return table;
}

ReportTable KeyframeTable(const Suite& suite, const std::vector<MethodResults>& results) {
  ReportTable table{
      "keyframes",
      "Keyframes with a label",
      "Medians of the runs. The delay is the median number of frames from the newest labeled keyframe to the "
      "frame that is tracked.",
      {"sequence", "configuration", "frames", "run time [s]", "keyframes", "labeled", "delay [frames]"},
      {}};
  for (std::size_t i = 0; i < suite.sequences.size(); ++i) {
    for (const MethodResults& method : results) {
      const std::vector<const nlohmann::json*> reports = Pointers(method.sequences[i].reports);
      if (!reports.empty()) {
        table.rows.push_back({{suite.sequences[i].name, ""},
                              {method.name, ""},
                              NumberCell(MedianOf(reports, "/frames"), 0),
                              NumberCell(MedianOf(reports, "/wall_s"), 1),
                              NumberCell(MedianOf(reports, "/keyframes"), 0),
                              NumberCell(MedianOf(reports, "/semantics/keyframes_labeled"), 0),
                              NumberCell(MedianOf(reports, "/semantics/delay_frames/median"), 0)});
      }
    }
    for (const PublishedMethod& method : suite.published) {
      if (const auto labeled = method.labeled_keyframes.find(suite.sequences[i].name);
          labeled != method.labeled_keyframes.end()) {
        for (const auto& [setting, count] : labeled->second) {
          table.rows.push_back({{suite.sequences[i].name, ""},
                                {method.name + ", " + setting, "published: " + method.source},
                                {"-", ""},
                                {"-", ""},
                                {"-", ""},
                                {fmt::format("{}", count), ""},
                                {"-", ""}});
        }
      }
    }
  }
  return table;
}

std::string ErrorsCsv(const Suite& suite, const std::vector<MethodResults>& results) {
  std::string csv =
      "sequence,method,poses_of,run,poses,frames,ate_rmse_m,ate_sd_m,rpe_translation_rmse_m,rpe_translation_sd_m,"
      "rpe_rotation_rmse_deg,rpe_rotation_sd_deg\n";
  const auto add = [&](const std::string& sequence, const std::string& method, const char* what,
                       const std::vector<RunErrors>& runs) {
    for (std::size_t i = 0; i < runs.size(); ++i) {
      const RunErrors& run = runs[i];
      csv += fmt::format("{},{},{},{},{},{},{:.6f},{:.6f},{:.6f},{:.6f},{:.6f},{:.6f}\n", CsvText(sequence),
                         CsvText(method), what, i + 1, run.poses, run.frames, run.ate_rmse_m, run.ate_std_m,
                         run.rpe_translation_rmse_m, run.rpe_translation_std_m, run.rpe_rotation_rmse_deg,
                         run.rpe_rotation_std_deg);
    }
  };
  for (const MethodResults& method : results) {
    for (std::size_t i = 0; i < suite.sequences.size(); ++i) {
      add(suite.sequences[i].name, method.name, "frames", method.sequences[i].frames);
      add(suite.sequences[i].name, method.name, "keyframes", method.sequences[i].keyframes);
    }
  }
  return csv;
}

std::string ThisMachine() {
  std::ifstream information("/proc/cpuinfo");
  std::string processor = "unknown processor";
  for (std::string line; std::getline(information, line);) {
    if (const std::size_t colon = line.find(": "); line.starts_with("model name") && colon != std::string::npos) {
      processor = line.substr(colon + 2);
      break;
    }
  }
  return fmt::format("{}, {} cores", processor, std::max(1L, sysconf(_SC_NPROCESSORS_ONLN)));
}

std::string HtmlText(std::string_view text) {
  std::string escaped;
  for (const char c : text) {
    escaped += c == '&' ? "&amp;" : c == '<' ? "&lt;" : c == '>' ? "&gt;" : c == '"' ? "&quot;" : std::string(1, c);
  }
  return escaped;
}

std::string ToMarkdown(const ReportTable& table) {
  const auto line = [](const std::vector<std::string>& cells) {
    return fmt::format("| {} |\n", fmt::join(cells, " | "));
  };
  std::string text = fmt::format("## {}\n\n{}\n\n", table.title, table.note) + line(table.headings);
  text += "|" + fmt::format("{}\n", fmt::join(std::vector<std::string>(table.headings.size(), "---|"), ""));
  for (const auto& row : table.rows) {
    std::vector<std::string> cells;
    for (const TableCell& cell : row) {
      cells.push_back(cell.aside.empty() ? cell.value : fmt::format("{} ({})", cell.value, cell.aside));
    }
    text += line(cells);
  }
  return text + "\n";
}

std::string ToHtml(const ReportTable& table) {
  std::string text = fmt::format("<h2>{}</h2>\n<p>{}</p>\n<div class=\"wide\"><table>\n<tr>", HtmlText(table.title),
                                 HtmlText(table.note));
  for (const std::string& heading : table.headings) {
    text += "<th>" + HtmlText(heading) + "</th>";
  }
  text += "</tr>\n";
  for (const auto& row : table.rows) {
    text += "<tr>";
    for (const TableCell& cell : row) {
      text += "<td>" + HtmlText(cell.value) +
              (cell.aside.empty() ? "" : "<br><small>" + HtmlText(cell.aside) + "</small>") + "</td>";
    }
    text += "</tr>\n";
  }
  return text + "</table></div>\n";
}

std::string ToCsv(const ReportTable& table) {
  std::string text;
  const auto add = [&text](const std::vector<std::string>& cells) {
    std::vector<std::string> quoted;
    std::ranges::transform(cells, std::back_inserter(quoted), CsvText);
    text += fmt::format("{}\n", fmt::join(quoted, ","));
  };
  add(table.headings);
  for (const auto& row : table.rows) {
    std::vector<std::string> cells;
    for (const TableCell& cell : row) {
      cells.push_back(cell.aside.empty() ? cell.value : fmt::format("{} ({})", cell.value, cell.aside));
    }
    add(cells);
  }
  return text;
}

}  // namespace rds
