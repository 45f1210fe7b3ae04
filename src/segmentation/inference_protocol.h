// SPDX-License-Identifier: Apache-2.0
// The tensors of the Open Inference Protocol (KServe v2) over HTTP, with its extension for binary data, which Triton,
// OpenVINO Model Server and KServe speak: JSON, and behind it the bytes of the tensors.
#pragma once

#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace rds {

// Names the length of the JSON where bytes follow it.
inline constexpr const char* kInferenceHeader = "Inference-Header-Content-Length";

struct InferenceTensor {
  std::string name;
  std::string datatype;  // "UINT8", "FP32", "BYTES", ...
  std::vector<std::int64_t> shape;
  std::string data;  // little-endian, row-major; of BYTES each element after its length in four bytes
};

struct InferenceBody {
  std::string bytes;
  std::size_t json_length = 0;
};

// A request or an answer: `json` with the tensors under `key` ("inputs", "outputs"), their data as bytes behind it.
[[nodiscard]] InferenceBody EncodeInference(nlohmann::json json, const char* key,
                                            const std::vector<InferenceTensor>& tensors);

struct InferenceMessage {
  nlohmann::json json;
  std::vector<InferenceTensor> tensors;
};

// The other way. `json_length`: what the header says; nothing = all is JSON. Data may also be in the JSON, as lists.
// InputError for what is no such message: no JSON, sizes that do not fit, unknown types.
[[nodiscard]] InferenceMessage DecodeInference(std::string_view body, std::optional<std::size_t> json_length,
                                               const char* key);

// The value of kInferenceHeader. InputError if it is no number.
[[nodiscard]] std::size_t ParseLength(const std::string& text);

// The numbers of a tensor. InputError for BYTES and types that are not read (FP16, BF16).
[[nodiscard]] std::vector<float> FloatsOf(const InferenceTensor& tensor);

// The elements of a tensor of BYTES, which may not be of another type.
[[nodiscard]] std::vector<std::string_view> StringsOf(const InferenceTensor& tensor);
// As an element of such a tensor.
[[nodiscard]] std::string AsBytesElement(std::string_view bytes);

}  // namespace rds
