#pragma once

#include "core/events/formats.hpp"

// Every format of this folder: a function each, listed in ../formats.cpp.
namespace evbench {

EventFormat aedat4_format();
EventFormat dat_format();
EventFormat ecd_text_format();
EventFormat es_format();
EventFormat evt2_format();
EventFormat evt21_format();
EventFormat evt3_format();
EventFormat hdf5_format();
EventFormat native_format();
EventFormat ros1_bag_format();
EventFormat mcap_format();
EventFormat ros2_folder_format();
EventFormat ros2_sqlite_format();

}  // namespace evbench
