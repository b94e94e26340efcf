#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/events/event_columns.hpp"
#include "core/events/hdf5/file.hpp"

namespace evbench::hdf5 {

/// Where an HDF5 file has a camera's events: in four columns of equal length, or in one data set of rows.
struct EventLayout {
  std::string name;           ///< of the data set, e.g. "DSEC"; otherwise its columns
  std::string group;          ///< of the columns, or the data set of rows
  std::string x, y, t, p;     ///< paths of the columns; empty for rows
  std::string index;          ///< path of the indices of the first event of each millisecond; empty: none
  std::string offset;         ///< path of the number that is added to all times; empty: none
  int width = 0, height = 0;  ///< sensor of that data set [px]; 0: unknown

  bool is_rows() const { return x.empty(); }
  const std::string& times() const { return is_rows() ? group : t; }  ///< path of the data set that has them
};

/// All layouts that are recognised, sorted by group:
///   DSEC     events/{x,y,p,t}, ms_to_idx, t_offset    (Gehrig et al., RA-L 2021)
///   TUM-VIE  events/{x,y,p,t}, ms_to_idx              (Klenk et al., IROS 2021)
///   M3ED     prophesee/left/{x,y,p,t}, ms_map_idx     (Chaney et al., CVPRW 2023)
///   MVSEC    davis/left/events, rows x y t p, t in s  (Zhu et al., RA-L 2018)
///   v2e      events, rows t x y p, t in µs            (Hu et al., CVPRW 2021)
/// and any group of columns x y t p, or xs ys ts ps, as in EDS (Hidalgo-Carrió et al., CVPR 2022).
std::vector<EventLayout> find_events(const File& file);

/// The layout that `topic` names (its group, or the beginning of it), or the first. Throws InputError if there is none.
EventLayout choose_events(const File& file, const std::string& topic);

/// The order of the columns of rows: MVSEC's, which is known; for others `asked`, as in ReadOptions::columns, or
/// whichever of t x y p, x y t p and x y p t the rows fit. Throws InputError if none or several fit.
EventOrder find_order(const EventLayout& layout, const Dataset& rows, const EventOrder& asked);

/// The time unit that the times' attribute `unit`, `units`, `time_unit` or `time_units` states, or one of the last two
/// of their group. Throws InputError if it is no unit of time.
TimeUnit find_time_unit(const File& file, const EventLayout& layout);

/// Width and height of the sensor [px], if the group or the file has them as attributes: width and height, or both in
/// sensor_resolution or resolution. There some files have the height first, so the larger number is the width.
std::optional<std::pair<int, int>> find_sensor_size(const File& file, const std::string& group);

}  // namespace evbench::hdf5
