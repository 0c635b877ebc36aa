// SPDX-License-Identifier: Apache-2.0
#include "trial_tables.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <string_view>

#include "clinical_columns.hpp"
#include "condyle/common/clinical_kinematics.hpp"
#include "condyle/io/motion_file.hpp"
#include "condyle/io/pose_table.hpp"

namespace condyle::apps {
namespace {

using fdk::TimeFrames;

constexpr std::array kLoads{"Fx", "Fy", "Fz", "Mx", "My", "Mz"};

/// One table over the time frames of a run.
class StoTable {
 public:
  StoTable(std::string name, const std::vector<double>& times) {
    motion_.name = std::move(name);
    motion_.times = times;
    motion_.in_degrees = false;
  }

  void add(const std::string& column, const TimeFrames& table, Eigen::Index index) {
    add(column, [&](Eigen::Index row) { return table(row, index); });
  }
  template <typename Get>
  void add(const std::string& column, const Get& get) {
    motion_.names.push_back(column);
    motion_.columns.emplace_back();
    for (std::size_t row = 0; row < motion_.times.size(); ++row) {
      motion_.columns.back().push_back(get(static_cast<Eigen::Index>(row)));
    }
  }
  ResultFile file() const { return {motion_.name + ".sto", io::motion_text(motion_)}; }

 private:
  io::Motion motion_;
};

/// OpenSim's endings of generalised forces: _moment [Nm] of rotations, _force [N] of translations.
std::string force_column(const model::CoordinateDescription& coordinate) {
  return coordinate.name + (coordinate.rotational ? "_moment" : "_force");
}

class Tables {
 public:
  explicit Tables(const TrialRun& run) : run_(run), simulation_(run.simulation) {}

  std::vector<ResultFile> make() {
    const model::ModelDescription& model = run_.model.description();
    std::vector<std::string> forces, reserves;
    for (const auto& coordinate : model.coordinates) forces.push_back(force_column(coordinate));
    for (const std::string& name : run_.balanced) {
      reserves.push_back(forces[static_cast<std::size_t>(run_.model.coordinate(name))]);
    }
    const auto muscles = names_of(model.muscles), ligaments = names_of(model.ligaments);
    add("coordinates", names_of(model.coordinates), simulation_.q);
    add("generalised_forces", forces, simulation_.generalised_forces);
    add("residuals", forces, simulation_.residuals);
    add("muscle_forces", muscles, simulation_.muscle_forces);
    add("activities", muscles, simulation_.activities);
    if (!simulation_.reserves.isZero(0.0)) add("reserves", reserves, simulation_.reserves);
    add("ligament_forces", ligaments, simulation_.ligament_forces);
    add("ligament_strains", ligaments, simulation_.ligament_strains);
    for (std::size_t c = 0; c < run_.contacts.size(); ++c) add_contact(c);
    return std::move(files_);
  }

 private:
  void add(const std::string& name, const std::vector<std::string>& columns,
           const TimeFrames& table) {
    if (columns.empty()) return;
    StoTable sto(name, run_.times);
    for (std::size_t c = 0; c < columns.size(); ++c) {
      sto.add(columns[c], table, static_cast<Eigen::Index>(c));
    }
    files_.push_back(sto.file());
  }

  void add_contact(std::size_t index) {
    const TrialContact& contact = run_.contacts[index];
    const auto c = static_cast<Eigen::Index>(index);
    const std::string& name = contact.description.name;
    StoTable sto(name + "_contact", run_.times);
    for (Eigen::Index i = 0; i < 6; ++i) {
      sto.add(io::pose_columns()[static_cast<std::size_t>(i)], simulation_.contact_poses,
              6 * c + i);
    }
    if (!contact.one_sided) add_sides(sto, "_", simulation_.contact_wrenches, c);
    for (Eigen::Index i = 0; i < 6; ++i) {
      sto.add(std::string("total_") + kLoads[static_cast<std::size_t>(i)], [&](Eigen::Index row) {
        return simulation_.contact_wrenches(row, 12 * c + i) +
               simulation_.contact_wrenches(row, 12 * c + 6 + i);
      });
    }
    if (!contact.one_sided) add_sides(sto, "_error_", simulation_.contact_errors, c);
    sto.add("trust", simulation_.contact_trust, c);
    files_.push_back(sto.file());
    if (!contact.one_sided) add_kinematics(contact, c);
    if (!run_.pressures[index]) return;
    add_pressures(name + "_pressures", *run_.pressures[index]);
    if (contact.made.surrogate) add_reference(name + "_reference", *run_.pressures[index]);
  }

  static void add_sides(StoTable& sto, const std::string& between, const TimeFrames& table,
                        Eigen::Index c) {
    for (const Side side : {kMedial, kLateral}) {
      for (Eigen::Index i = 0; i < 6; ++i) {
        sto.add(std::string(name(side)) + between + kLoads[static_cast<std::size_t>(i)], table,
                12 * c + 6 * side + i);
      }
    }
  }

  void add_kinematics(const TrialContact& contact, Eigen::Index c) {
    std::vector<ClinicalKinematics> clinical;
    for (Eigen::Index row = 0; row < simulation_.contact_poses.rows(); ++row) {
      const Pose pose = simulation_.contact_poses.row(row).segment<6>(6 * c).transpose();
      clinical.push_back(clinical_kinematics(pose, contact.description.side_of_body));
    }
    StoTable sto(contact.description.name + "_kinematics", run_.times);
    for (const auto& [column, member] : kClinicalColumns) {
      sto.add(column,
              [&](Eigen::Index row) { return clinical[static_cast<std::size_t>(row)].*member; });
    }
    files_.push_back(sto.file());
  }

  void add_pressures(const std::string& name, const ContactPressures& pressures) {
    using Member = double PartPressure::*;
    StoTable sto(name, run_.times);
    for (std::size_t p = 0; p < pressures.parts.size(); ++p) {
      const auto part = [&, p](Eigen::Index row) -> const PartPressure& {
        return pressures.frames[static_cast<std::size_t>(row)][p];
      };
      const auto add = [&](const char* column, Member member) {
        sto.add(pressures.parts[p] + column, [&](Eigen::Index row) { return part(row).*member; });
      };
      for (int i = 0; i < 3; ++i) {
        sto.add(pressures.parts[p] + "_cop_" + "xyz"[i],
                [&](Eigen::Index row) { return part(row).centre[i]; });
      }
      add("_peak_pressure", &PartPressure::peak);
      if (pressures.has_mean) add("_mean_pressure", &PartPressure::mean);
      add("_area", &PartPressure::area);
      add("_max_depth", &PartPressure::max_depth);
      add("_border_area", &PartPressure::border_area);
    }
    files_.push_back(sto.file());
  }

  void add_reference(const std::string& name, const ContactPressures& pressures) {
    StoTable sto(name, run_.times);
    for (std::size_t p = 0; p < pressures.parts.size(); ++p) {
      for (Eigen::Index i = 0; i < 6; ++i) {
        sto.add(pressures.parts[p] + "_" + kLoads[static_cast<std::size_t>(i)],
                [&](Eigen::Index row) {
                  return pressures.frames[static_cast<std::size_t>(row)][p].wrench[i];
                });
      }
    }
    files_.push_back(sto.file());
  }

  const TrialRun& run_;
  const fdk::TrialSimulation& simulation_;
  std::vector<ResultFile> files_;
};

/// Fields of a line of CSV; a word that holds a comma, a quote or the end of a line stands in
/// quotes (RFC 4180).
class CsvLine {
 public:
  CsvLine& operator<<(std::string_view word) {
    if (word.find_first_of(",\"\r\n") == std::string_view::npos) return append(std::string(word));
    std::string quoted = "\"";
    for (const char letter : word)
      quoted += letter == '"' ? std::string("\"\"") : std::string(1, letter);
    return append(quoted + '"');
  }
  CsvLine& operator<<(double value) {
    char digits[32];
    return append({digits, std::to_chars(std::begin(digits), std::end(digits), value).ptr});
  }
  CsvLine& operator<<(int value) { return append(std::to_string(value)); }
  const std::string& text() const { return text_; }

 private:
  CsvLine& append(const std::string& field) {
    text_ += (text_.empty() ? "" : ",") + field;
    return *this;
  }
  std::string text_;
};

ResultFile record_file(const TrialRun& run) {
  std::string text =
      "time,status,approach,iterations,evaluations,substeps,worst_coordinate,worst_residual,"
      "scaled_residual,remaining_m,remaining_rad,attainable_N,attainable_Nm,sharing_settled,trust,"
      "message\n";
  const std::vector<double> scaled = scaled_residuals(run);
  for (std::size_t i = 0; i < run.times.size(); ++i) {
    const fdk::ForceDependentRecord& record = run.simulation.records[i];
    CsvLine line;
    line << run.times[i] << name(record.status) << name(record.approach) << record.iterations
         << record.evaluations << record.substeps << record.worst_name
         << record.residual[record.worst_coordinate] << scaled[i] << record.remaining_m
         << record.remaining_rad << record.attainable_force << record.attainable_moment
         << (record.sharing_settled ? "True" : "False") << record.least_trust << record.message;
    text += line.text() + '\n';
  }
  return {"record.csv", text};
}

}  // namespace

std::vector<ResultFile> trial_tables(const TrialRun& run) {
  std::vector<ResultFile> files = Tables(run).make();
  files.push_back(record_file(run));
  return files;
}

}  // namespace condyle::apps
