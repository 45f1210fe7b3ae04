// SPDX-License-Identifier: Apache-2.0
// Things by id, in memory that follows how many live, not how many ever lived.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "base/error.h"

namespace rds {

// Ids of a table come in pages of so many; whoever keeps something by id outside may do it by the same pages.
inline constexpr std::size_t kIdsPerPage = 256;
// Pages that can live at once: 67 million ids. More than memory holds of what lives on them.
inline constexpr std::size_t kIdPages = std::size_t{1} << 18U;

// Owns values of type T by an Id given here in ascending order (after 2^32 of them from 0 again, which takes weeks). A
// page whose values are all dead is given back, and its place is used again; ids whose place is still taken by an old
// page are left out. Not thread-safe.
template <typename IdType, typename T>
class IdTable {
 public:
  // `pages`: at most so many live at once; rounded up to a power of two.
  explicit IdTable(std::size_t pages = kIdPages) : pages_(std::bit_ceil(pages)), mask_(pages_.size() - 1) {}

  // Null if there is none (any more).
  [[nodiscard]] T* Find(IdType id) const {
    const Page* const page = pages_[PageOf(id) & mask_].get();
    return page != nullptr && page->number == PageOf(id) ? page->values[id.index() % kIdsPerPage].get() : nullptr;
  }

  // The id that Add gives next. InvariantError if every page holds something that lives.
  [[nodiscard]] IdType NextId() {
    IdType next = next_;
    for (std::size_t tries = 0; tries <= pages_.size(); ++tries) {
      const std::unique_ptr<Page>& page = pages_[PageOf(next) & mask_];
      if (next.valid() && (page == nullptr || page->number == PageOf(next))) {
        return next_ = next;
      }
      next = IdType{static_cast<std::uint32_t>((next.index() / kIdsPerPage + 1) * kIdsPerPage)};
    }
    throw InvariantError("the table of ids is full");
  }

  // Stores a value under NextId().
  T& Add(std::unique_ptr<T> value) {
    const IdType id = NextId();
    std::unique_ptr<Page>& page = pages_[PageOf(id) & mask_];
    if (page == nullptr) {
      page = std::make_unique<Page>();
      page->number = PageOf(id);
    }
    ++page->living;
    ++size_;
    next_ = IdType{id.value + 1};
    return *(page->values[id.index() % kIdsPerPage] = std::move(value));
  }

  // Destroys the value, which must be there.
  void Erase(IdType id) {
    Check(Find(id) != nullptr, "what is erased is there");
    std::unique_ptr<Page>& page = pages_[PageOf(id) & mask_];
    page->values[id.index() % kIdsPerPage].reset();
    --size_;
    if (--page->living == 0 && page->number != PageOf(next_)) {  // else more ids of this page are to be given
      freed_.push_back(page->number);
      page.reset();
    }
  }

  // How many live.
  [[nodiscard]] std::size_t size() const { return size_; }

  // The ids of those that live, in the order in which they were given.
  [[nodiscard]] std::vector<IdType> Ids() const {
    std::vector<const Page*> living;
    for (const std::unique_ptr<Page>& page : pages_) {
      if (page != nullptr) {
        living.push_back(page.get());
      }
    }
    std::ranges::sort(living, {}, &Page::number);
    std::vector<IdType> ids;
    ids.reserve(size_);
    for (const Page* page : living) {
      for (std::size_t i = 0; i < kIdsPerPage; ++i) {
        if (page->values[i] != nullptr) {
          ids.push_back(IdType{static_cast<std::uint32_t>(page->number * kIdsPerPage + i)});
        }
      }
    }
    return ids;
  }

  // Numbers (id / kIdsPerPage) of the pages given back since the last call, for those who keep something by id.
  [[nodiscard]] std::vector<std::uint32_t> TakeFreedPages() { return std::exchange(freed_, {}); }

 private:
  struct Page {
    std::uint32_t number = 0;
    int living = 0;
    std::array<std::unique_ptr<T>, kIdsPerPage> values;
  };

  static std::uint32_t PageOf(IdType id) { return static_cast<std::uint32_t>(id.index() / kIdsPerPage); }

  std::vector<std::unique_ptr<Page>> pages_;  // page n at n & mask_
  std::size_t mask_;
  IdType next_{0};
  std::size_t size_ = 0;
  std::vector<std::uint32_t> freed_;
};

}  // namespace rds
