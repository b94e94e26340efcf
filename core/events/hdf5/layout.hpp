#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/events/event_columns.hpp"
#include "core/events/hdf5/file.hpp"

namespace evbench::hdf5 {

/// Where an HDF5 file has a camera's events: four columns of equal length, or one data set of rows.
struct EventLayout {
  std::string name;           ///< whose layout, e.g. "DSEC"; otherwise what is there
  std::string group;          ///< of the columns; the data set of rows
  std::string x, y, t, p;     ///< paths of the columns; empty for rows
  std::string index;          ///< path of the first event of each millisecond; empty: none
  std::string offset;         ///< path of what is to be added to all times [µs]; empty: nothing
  int width = 0, height = 0;  ///< sensor of that data set [px]; 0: unknown

  bool is_rows() const { return x.empty(); }
  const std::string& times() const { return is_rows() ? group : t; }  ///< path of the data set that has them
};

/// All that are recognised, sorted by group:
///   DSEC     events/{x,y,p,t}, ms_to_idx, t_offset    (Gehrig et al., RA-L 2021)
///   TUM-VIE  events/{x,y,p,t}, ms_to_idx              (Klenk et al., IROS 2021)
///   M3ED     prophesee/left/{x,y,p,t}, ms_map_idx     (Chaney et al., CVPRW 2023)
///   MVSEC    davis/left/events, rows x y t p, t in s  (Zhu et al., RA-L 2018)
///   v2e      events, rows t x y p, t in µs            (Hu et al., CVPRW 2021)
/// and any group of columns x y t p, or xs ys ts ps, as in EDS (Hidalgo-Carrió et al., CVPR 2022).
std::vector<EventLayout> find_events(const File& file);

/// The one that `topic` names (its group, or the beginning of it), or the first. Throws InputError when there is none.
EventLayout choose_events(const File& file, const std::string& topic);

/// The order of rows: the known one of MVSEC; for others `asked`, as ReadOptions::columns has it, or whichever of
/// t x y p, x y t p and x y p t they fit. Throws InputError where none or several do.
EventOrder find_order(const EventLayout& layout, const Dataset& rows, const EventOrder& asked);

/// What the times' attribute `unit`, `units`, `time_unit` or `time_units` says, or one of the last two of their group.
/// Throws InputError where it is no unit of time.
TimeUnit find_time_unit(const File& file, const EventLayout& layout);

/// Width and height of the sensor [px] where an attribute of the group or the file has them: width and height, or both
/// in sensor_resolution or resolution, where some have the height first: sensors are wider than high.
std::optional<std::pair<int, int>> find_sensor_size(const File& file, const std::string& group);

}  // namespace evbench::hdf5
