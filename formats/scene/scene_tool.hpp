// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <initializer_list>
#include <optional>

#include "formats/scene/scene.hpp"
#include "formats/scene/table_reader.hpp"

namespace spm {

/// The keys of `[tool]`.
inline constexpr std::initializer_list<const char*> tool_keys{
    "probe",    "paper_probe", "asset",      "mesh",    "pose",    "scale",
    "coupling", "turning",     "torque_cap", "samples", "spacing", "budget"};

/// The table's `probe`; nothing where it has none.
[[nodiscard]] std::optional<ProbeShape> read_probe(TableReader& tool);

/// What a force of method `paper` is the mean over; nothing where the table does not say.
[[nodiscard]] std::optional<PaperProbeForm> read_probe_form(TableReader& tool);

/// The object that is the tool; nothing where the table names none. Its paths are as written.
[[nodiscard]] std::optional<SceneTool> read_tool(TableReader& tool);

}  // namespace spm
