// SPDX-License-Identifier: Apache-2.0
#include "cli/suite_report.h"

#include <spdlog/fmt/fmt.h>

#include <cmath>
#include <cstdint>
#include <opencv2/imgcodecs.hpp>
#include <system_error>
#include <utility>
#include <vector>

#include "base/base64.h"
#include "base/file.h"
#include "base/version.h"
#include "cli/suite_runner.h"
#include "cli/suite_tables.h"
#include "eval/line_plot.h"
#include "eval/plot.h"
#include "io/atomic_file.h"

namespace rds {
namespace {

namespace fs = std::filesystem;

// Readable on a phone: one column, tables that scroll sideways, pictures no wider than the screen.
constexpr const char* kStyle =
    R"(<meta charset="utf-8"><meta name="viewport" content="width=device-width, initial-scale=1">
<style>
body { font: 16px/1.45 Helvetica, Arial, sans-serif; color: #222; max-width: 60rem; margin: 0 auto; padding: 0 1rem 3rem; }
h1 { font-size: 1.6rem; } h2 { font-size: 1.2rem; margin-top: 2.2rem; } h3 { font-size: 1rem; }
.wide { overflow-x: auto; } table { border-collapse: collapse; font-size: .9rem; }
th, td { border-bottom: 1px solid #ddd; padding: .35rem .7rem; text-align: left; vertical-align: top; white-space: nowrap; }
td:first-child, td small { white-space: normal; } td:first-child { min-width: 8rem; }
th { background: #f4f4f4; } small { color: #666; } svg, img { max-width: 100%; height: auto; }
.problem { background: #fff0f0; border-left: 4px solid #c00; padding: .4rem .8rem; }
</style>
)";

struct Figure {
  std::string file;  // in figures/
  std::string svg;
};

struct FigureGroup {
  std::string title;
  std::string note;
  std::vector<Figure> figures;
};

// How many frames the newest label lies behind, over the frames (figures 6 and 16 of the paper).
FigureGroup DelayFigures(const Suite& suite, const std::vector<MethodResults>& results) {
  FigureGroup group{
      "Semantic delay", "Frames from the newest labeled keyframe to the frame that is tracked, in the first run.", {}};
  for (std::size_t i = 0; i < suite.sequences.size(); ++i) {
    std::vector<LineSeries> lines;
    for (const MethodResults& method : results) {
      if (method.sequences[i].folders.empty()) {
        continue;
      }
      const std::vector<double> delays =
          ReadColumn(method.sequences[i].folders.front() / "frames.csv", "semantic_delay_frames");
      LineSeries line{method.name, {}};
      bool any = false;
      for (std::size_t frame = 0; frame < delays.size(); ++frame) {
        line.points.emplace_back(static_cast<double>(frame), delays[frame]);
        any = any || std::isfinite(delays[frame]);
      }
      if (any) {
        lines.push_back(std::move(line));
      }
    }
    if (!lines.empty()) {
      group.figures.push_back({fmt::format("delay_{}.svg", AsFileName(suite.sequences[i].name)),
                               PlotLines(suite.sequences[i].name, "frame", "delay [frames]", lines)});
    }
  }
  return group;
}

// Estimated and true paths (figure 14).
FigureGroup TrajectoryFigures(const Suite& suite, const std::vector<MethodResults>& results) {
  FigureGroup group{"Trajectories", "The run with the median error of each, colored by its error.", {}};
  for (std::size_t i = 0; i < suite.sequences.size(); ++i) {
    for (const MethodResults& method : results) {
      if (const auto& median = method.sequences[i].median) {
        group.figures.push_back(
            {fmt::format("trajectory_{}_{}.svg", AsFileName(suite.sequences[i].name), AsFileName(method.name)),
             PlotTrajectories(*median, suite.sequences[i].name + ", " + method.name)});
      }
    }
  }
  return group;
}

// A picture as small as a page with dozens of them wants it.
std::string AsJpeg(const cv::Mat& picture) {
  std::vector<std::uint8_t> bytes;
  cv::imencode(".jpg", picture, bytes, {cv::IMWRITE_JPEG_QUALITY, 80});
  return {bytes.begin(), bytes.end()};
}

// Frames with their features by state (figures 12 and 13).
void AddPictures(const Suite& suite, const fs::path& out, std::string& html, std::string& markdown) {
  std::string html_part;
  std::string markdown_part;
  for (const SuiteSequence& sequence : suite.sequences) {
    for (const SuiteConfiguration& configuration : suite.configurations) {
      for (const int frame : suite.pictures) {
        const fs::path file = PictureFile(out, sequence, configuration, frame);
        std::error_code error;
        const cv::Mat picture = fs::is_regular_file(file, error) ? cv::imread(file.string()) : cv::Mat();
        if (picture.empty()) {  // not made, or damaged
          continue;
        }
        const std::string title = fmt::format("{}, {}, frame {}", sequence.name, configuration.name, frame);
        html_part +=
            fmt::format("<h3>{0}</h3>\n<img alt=\"{0}\" loading=\"lazy\" src=\"data:image/jpeg;base64,{1}\">\n",
                        HtmlText(title), Base64(AsJpeg(picture)));
        markdown_part += fmt::format("### {0}\n\n![{0}](<{1}>)\n\n", title, fs::relative(file, out).string());
      }
    }
  }
  if (!html_part.empty()) {
    constexpr const char* kNote =
        "Blue: static, used first. Green: unknown. Red: dynamic, not used. The newest mask and "
        "the map from above beside it.";
    html += fmt::format("<h2>Features by state</h2>\n<p>{}</p>\n", kNote) + html_part;
    markdown += fmt::format("## Features by state\n\n{}\n\n", kNote) + markdown_part;
  }
}

}  // namespace

void WriteSuiteReport(const Suite& suite, const std::vector<MethodResults>& results,
                      const std::vector<std::string>& problems, const fs::path& out) {
  PrepareOutputFolder(out / "figures");
  std::vector<OutputFile> files;
  const std::string about = fmt::format("rds {}, {}; repetitions of what is not in lockstep: {}.", kVersion,
                                        ThisMachine(), suite.repetitions);
  std::string markdown = fmt::format("# {}\n\n{}\n\n", suite.title, about);
  std::string html = fmt::format(
      "<!doctype html>\n<html lang=\"en\"><head><title>{0}</title>\n{1}</head><body>\n<h1>{0}</h1>\n"
      "<p>{2}</p>\n",
      HtmlText(suite.title), kStyle, HtmlText(about));
  for (const std::string& problem : problems) {
    markdown += "**" + problem + "**\n\n";
    html += "<p class=\"problem\">" + HtmlText(problem) + "</p>\n";
  }
  std::vector<ReportTable> tables = ErrorTables(suite, results);
  tables.push_back(TimeTable(suite, results));
  tables.push_back(KeyframeTable(suite, results));
  for (const ReportTable& table : tables) {
    if (!table.rows.empty()) {
      markdown += ToMarkdown(table);
      html += ToHtml(table);
      files.push_back({out / (table.file + ".csv"), ToCsv(table)});
    }
  }
  for (const FigureGroup& group : {DelayFigures(suite, results), TrajectoryFigures(suite, results)}) {
    if (group.figures.empty()) {
      continue;
    }
    markdown += fmt::format("## {}\n\n{}\n\n", group.title, group.note);
    html += fmt::format("<h2>{}</h2>\n<p>{}</p>\n", HtmlText(group.title), HtmlText(group.note));
    for (const Figure& figure : group.figures) {
      markdown += fmt::format("![{0}](figures/{0})\n\n", figure.file);
      html += figure.svg;
      files.push_back({out / "figures" / figure.file, figure.svg});
    }
  }
  AddPictures(suite, out, html, markdown);
  files.push_back({out / "errors.csv", ErrorsCsv(suite, results)});
  files.push_back({out / "report.md", markdown});
  files.push_back({out / "report.html", html + "</body></html>\n"});
  WriteFilesAtomically(files);
}

}  // namespace rds
